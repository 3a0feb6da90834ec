#include "support/structured_lti.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "support/rng.hpp"

namespace titop_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using titop::Lti;

/// Residues modulo a Mersenne prime. Entries here are far from 2^61 apart.
constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;
__extension__ typedef unsigned __int128 Wide;

std::uint64_t product(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::uint64_t>(Wide{a} * b % kPrime);
}
std::uint64_t power(std::uint64_t a, std::uint64_t exponent) {
  std::uint64_t result = 1;
  for (; exponent > 0; exponent >>= 1, a = product(a, a))
    if (exponent & 1) result = product(result, a);
  return result;
}
std::uint64_t residue(double x) {
  const double whole = std::ldexp(std::abs(x), 40);
  if (whole != std::floor(whole) || whole > 0x1p62) throw std::logic_error("no short fraction");
  const std::uint64_t r =
      product(static_cast<std::uint64_t>(whole) % kPrime, power(power(2, 40), kPrime - 2));
  return x < 0 && r > 0 ? kPrime - r : r;
}

using Table = std::vector<std::vector<std::uint64_t>>;

Table residues(const MatrixXd& m) {
  Table t(static_cast<std::size_t>(m.rows()));
  for (Index i = 0; i < m.rows(); ++i)
    for (const double x : m.row(i)) t[static_cast<std::size_t>(i)].push_back(residue(x));
  return t;
}

Table times(const Table& a, const Table& b) {
  Table c(a.size(), std::vector<std::uint64_t>(b.empty() ? 0 : b[0].size(), 0));
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < b.size(); ++k)
      for (std::size_t j = 0; j < c[i].size(); ++j)
        c[i][j] = (c[i][j] + product(a[i][k], b[k][j])) % kPrime;
  return c;
}

int rank(Table t) {
  std::size_t found = 0;
  for (std::size_t column = 0; !t.empty() && column < t[0].size(); ++column) {
    std::size_t pivot = found;
    while (pivot < t.size() && t[pivot][column] == 0) ++pivot;
    if (pivot == t.size()) continue;
    std::swap(t[pivot], t[found]);
    const std::uint64_t inverse = power(t[found][column], kPrime - 2);
    for (std::size_t i = found + 1; i < t.size(); ++i) {
      const std::uint64_t by = product(t[i][column], inverse);
      for (std::size_t j = column; by != 0 && j < t[i].size(); ++j)
        t[i][j] = (t[i][j] + kPrime - product(by, t[found][j])) % kPrime;
    }
    ++found;
  }
  return static_cast<int>(found);
}

int order_of(const Lti& m) {
  const Table A = residues(m.A);
  Table reached(A.size()), seen;
  Table columns = residues(m.B), rows = residues(m.C);
  for (std::size_t power = 0; power < A.size(); ++power) {
    for (std::size_t i = 0; i < A.size(); ++i)
      reached[i].insert(reached[i].end(), columns[i].begin(), columns[i].end());
    seen.insert(seen.end(), rows.begin(), rows.end());
    columns = times(A, columns);
    rows = times(rows, A);
  }
  return rank(times(seen, reached));
}

struct LtiBuilder {
  Rng rng;

  double pick(std::initializer_list<double> list) {
    return list.begin()[rng.below(static_cast<int>(list.size()))];
  }
  double gain() {
    const double size = pick({0.25, 0.5, 0.75, 1, 1.25, 1.5, 2, 3, 4});
    return size * rng.sign();
  }
  /// 1 / (s + pole)^n, or with a zero as well.
  Lti multiple(double pole, int n, bool zero) {
    Lti m{.A = MatrixXd(-pole * MatrixXd::Identity(n, n)),
          .B = MatrixXd::Zero(n, 1),
          .C = MatrixXd::Zero(1, n)};
    m.A.diagonal(1).setOnes();
    m.B(n - 1, 0) = 1;
    m.C(0, 0) = 1;
    if (zero) m.C(0, 1) = gain();
    return m;
  }
  Lti oscillator(double damping, bool rate) {
    const double stiffness = pick({0.25, 1, 4, 16, 256});
    return {.A = MatrixXd{{0, 1}, {-stiffness, -damping}},
            .B = MatrixXd{{0}, {1}},
            .C = rate ? MatrixXd{{0, 1}} : MatrixXd{{1, 0}}};
  }
  Lti small() {
    switch (rng.below(6)) {
      case 0: return multiple(0, 1 + rng.below(3), false);
      case 1: return multiple(pick({0.5, 1, 2, 4, 1.0 / 64, 64}), 1, false);
      case 2: return oscillator(0, false);
      case 3: return oscillator(0.125, false);
      case 4: {
        const bool zero = rng.chance(0.5);
        const int times = 2 + rng.below(2);
        return multiple(pick({0.5, 1, 2, 4}), times, zero);
      }
      default: return oscillator(0.0625, true);
    }
  }
  MatrixXd gains(Index rows, Index cols, double probability) {
    MatrixXd m = MatrixXd::Zero(rows, cols);
    for (double& x : m.reshaped())
      if (rng.chance(probability)) x = gain();
    return m;
  }
};

/// State i in units of 2^k, k between -20 and 20.
void change_units(Lti& m, Rng& rng) {
  for (Index i = 0; i < m.A.rows(); ++i) {
    const double unit = std::ldexp(1.0, rng.below(41) - 20);
    m.A.row(i) *= unit, m.B.row(i) *= unit;
    m.A.col(i) /= unit, m.C.col(i) /= unit;
  }
}

}  // namespace

StructuredLti structured_lti(std::uint64_t seed, bool units) {
  LtiBuilder b{Rng(seed)};
  const int count = 2 + b.rng.below(4);
  std::vector<Lti> parts;
  std::vector<Index> first;
  Index states = 0;
  for (int i = 0; i < count; ++i) {
    const bool again = i > 0 && b.rng.chance(0.35);
    parts.push_back(again ? Lti(parts[static_cast<std::size_t>(b.rng.below(i))]) : b.small());
    first.push_back(states);
    states += parts.back().A.rows();
  }
  MatrixXd into = MatrixXd::Zero(states, count), out = MatrixXd::Zero(count, states);
  StructuredLti result;
  Lti& m = result.lti;
  m.A = MatrixXd::Zero(states, states);
  for (int i = 0; i < count; ++i) {
    const Lti& part = parts[static_cast<std::size_t>(i)];
    const Index at = first[static_cast<std::size_t>(i)], n = part.A.rows();
    m.A.block(at, at, n, n) = part.A;
    into.block(at, i, n, 1) = part.B;
    out.block(i, at, 1, n) = part.C;
  }
  MatrixXd couplings = b.gains(count, count, 0.12);  // loops
  couplings.triangularView<Eigen::Lower>() = b.gains(count, count, 0.4);
  couplings.diagonal().setZero();
  m.A += into * couplings * out;
  m.B = into * b.gains(count, 1 + b.rng.below(2), 0.5);
  m.C = b.gains(1 + b.rng.below(2), count, 0.5) * out;
  result.order = order_of(m);
  if (units) change_units(m, b.rng);
  return result;
}

}  // namespace titop_test
