#include <algorithm>
#include <boost/multiprecision/eigen.hpp>
#include <complex>
#include <titop/graph/linalg/eigen.hpp>

#include "generate/assembly.hpp"
#include "generate/generate.hpp"

namespace titop::generate {
namespace {

using Complex = std::complex<double>;

constexpr std::uint64_t kNextSeed = 1000003;

/// A smaller pole is 0: of six at 0 the rounding of 100 digits leaves its sixth root.
constexpr double kAtRest = 1e-15;

/// Eigenvalues with Im s >= 0, slow ones first; 0 if at the rounding level of 100 digits.
std::vector<Complex> poles(const Table<Digits>& A) {
  const auto n = static_cast<Eigen::Index>(A.rows());
  if (n == 0) return {};
  Eigen::Matrix<Digits, Eigen::Dynamic, Eigen::Dynamic> M(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      M(i, j) = A(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  Eigen::RealSchur<decltype(M)> schur(n);
  schur.setMaxIterations(400 * n);
  schur.compute(M, /*computeU=*/false);
  const auto& T = schur.matrixT();
  std::vector<Complex> list;
  const auto rounded = [](const Digits& x) {
    const double value = static_cast<double>(x);
    return std::abs(value) > kAtRest ? value : 0;
  };
  for (Eigen::Index i = 0; i < n;) {
    if (i + 1 == n || T(i + 1, i) == 0) {
      list.emplace_back(rounded(T(i, i)), 0);
      ++i;
      continue;
    }
    const Digits middle = (T(i, i) + T(i + 1, i + 1)) / 2, half = (T(i, i) - T(i + 1, i + 1)) / 2;
    const Digits under = half * half + T(i, i + 1) * T(i + 1, i);
    const Digits root = sqrt(Digits(abs(under)));
    if (under < 0) {
      list.emplace_back(rounded(middle), rounded(root));
      if (list.back().imag() == 0) list.push_back(list.back());  // a double pole, apart by rounding
    } else {
      list.emplace_back(rounded(middle + root), 0);
      list.emplace_back(rounded(middle - root), 0);
    }
    i += 2;
  }
  std::sort(list.begin(), list.end(), [](const Complex& a, const Complex& b) {
    return std::pair(std::abs(a), a.real()) < std::pair(std::abs(b), b.real());
  });
  return list;
}

/// C (s - A)^-1 B + D, real and imaginary part below one another in one real system.
Json transfer(const FirstOrder<Digits>& m, Complex s) {
  const std::size_t n = m.A.rows(), nu = m.B.cols();
  Table<Digits> both(2 * n, 2 * n), right(2 * n, nu), re = m.D, im(m.D.rows(), nu);
  both.add(-m.A), both.add(-m.A, n, n);
  right.add(m.B);
  for (std::size_t i = 0; i < n; ++i) {
    both(i, i) += Digits(s.real()), both(n + i, n + i) += Digits(s.real());
    both(i, n + i) -= Digits(s.imag()), both(n + i, i) += Digits(s.imag());
  }
  const Table<Digits> X = solve(both, right);
  std::vector<std::size_t> top(n), bottom(n);
  for (std::size_t i = 0; i < n; ++i) top[i] = i, bottom[i] = n + i;
  re.add(m.C * X.rows(top)), im.add(m.C * X.rows(bottom));
  Json rows = Json::array();
  for (std::size_t i = 0; i < re.rows(); ++i) {
    Json row = Json::array();
    for (std::size_t j = 0; j < nu; ++j)
      row.push_back({static_cast<double>(re(i, j)), static_cast<double>(im(i, j))});
    rows.push_back(row);
  }
  return {{"s", {s.real(), s.imag()}}, {"G", rows}};
}

/// Two points near every pole, at the scene's own frequencies.
std::vector<Complex> points(const std::vector<Complex>& poles, std::uint64_t seed) {
  Mersenne draws(seed ^ 0xF00D);
  std::vector<Complex> list;
  while (list.size() < 2) {
    const double mantissa = 16 + draws.below(16);
    const double omega = std::ldexp(mantissa, draws.below(8) - 4);
    const Complex s(omega / 4, omega);
    const bool beside = std::all_of(poles.begin(), poles.end(), [&](const Complex& p) {
      return std::abs(s - p) > 0.05 * std::abs(s);
    });
    if (beside) list.push_back(s);
  }
  return list;
}

}  // namespace

Json answer(const ScenePlan& plan, std::uint64_t seed) {
  const FirstOrder<Digits> whole = assemble<Digits>(plan), least = minimal(whole);
  const std::size_t order = minimal(assemble<Mod>(plan)).A.rows();
  if (least.A.rows() != order)
    throw std::logic_error("order " + std::to_string(order) + " modulo a prime, " +
                           std::to_string(least.A.rows()) + " in 100 digits");
  const std::vector<Complex> list = poles(least.A);
  Json result = {{"order", order}, {"poles", Json::array()}, {"transfer", Json::array()}};
  for (const Complex& p : list) result["poles"].push_back({p.real(), p.imag()});
  for (const Complex& s : points(list, seed)) result["transfer"].push_back(transfer(whole, s));
  return result;
}

Generated generate(const GenerateOptions& options) {
  std::string lacked;
  for (GenerateOptions o = options; o.seed < options.seed + 100 * kNextSeed; o.seed += kNextSeed) {
    try {
      const ScenePlan plan = draw(o);
      if (o.mistake.empty()) return {scene(plan), answer(plan, o.seed)};
      Spoilt spoilt = spoil(scene(plan), o.mistake);
      return {std::move(spoilt.scene), std::move(spoilt.answer)};
    } catch (const std::domain_error& e) {  // no solution, or no place for the mistake: another one
      if (!o.mistake.empty()) lacked = e.what();
    } catch (const std::overflow_error&) {  // its ratios outgrow 64 bits: another one
    }
  }
  if (!lacked.empty())
    throw std::invalid_argument("none of 100 scenes has a place for the mistake '" +
                                options.mistake + "': " + lacked);
  throw std::invalid_argument(
      "none of 100 random diagrams of this kind is valid; change the options");
}

}  // namespace titop::generate
