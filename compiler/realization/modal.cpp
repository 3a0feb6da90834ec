#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <titop/compiler/realization/modal.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/graded.hpp>

namespace titop {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// qdot of each q: rows of A that are one unit vector. Empty if the states do not pair up.
std::vector<std::pair<int, int>> pairs(const MatrixXd& A) {
  const int n = static_cast<int>(A.rows());
  std::vector<int> velocity(static_cast<std::size_t>(n), -1);
  std::vector<char> is_velocity(static_cast<std::size_t>(n), 0);
  for (int i = 0; i < n; ++i) {
    int found = -1, count = 0;
    for (int j = 0; j < n; ++j)
      if (A(i, j) != 0) ++count, found = j;
    if (count == 1 && A(i, found) == 1 && found != i) velocity[static_cast<std::size_t>(i)] = found;
  }
  std::vector<std::pair<int, int>> result;
  for (int i = 0; i < n; ++i) {
    const int v = velocity[static_cast<std::size_t>(i)];
    if (v < 0 || velocity[static_cast<std::size_t>(v)] >= 0) continue;
    if (is_velocity[static_cast<std::size_t>(v)]) return {};
    is_velocity[static_cast<std::size_t>(v)] = 1;
    result.emplace_back(i, v);
  }
  return 2 * static_cast<int>(result.size()) == n ? result : std::vector<std::pair<int, int>>{};
}

/// Squares of a diagonal scaling d that makes K symmetric: d_j^2 / d_i^2 = K_ji / K_ij along the
/// maximum spanning tree of the couplings, since a weak coupling gives a noisy ratio. Empty if two
/// entries have different signs.
VectorXd symmetrizer(const MatrixXd& K) {
  const auto n = K.rows();
  VectorXd d2 = VectorXd::Zero(n), best = VectorXd::Constant(n, -1);
  Eigen::VectorXi from = Eigen::VectorXi::Constant(n, -1);
  for (Eigen::Index step = 0; step < n; ++step) {
    Eigen::Index i = -1;
    for (Eigen::Index j = 0; j < n; ++j)
      if (d2(j) == 0 && (i < 0 || best(j) > best(i))) i = j;
    const auto parent = from(i);
    d2(i) = parent < 0 ? 1 : d2(parent) * std::abs(K(i, parent) / K(parent, i));
    for (Eigen::Index j = 0; j < n; ++j) {
      if (d2(j) != 0 || K(i, j) == 0 || K(j, i) == 0) continue;
      if ((K(i, j) < 0) != (K(j, i) < 0)) continue;
      const double strength =
          std::sqrt(std::abs(K(i, j) / K(i, i))) * std::sqrt(std::abs(K(j, i) / K(j, j)));
      if (strength > best(j)) best(j) = strength, from(j) = static_cast<int>(i);
    }
  }
  return d2.allFinite() && (d2.array() > 0).all() ? d2 : VectorXd();
}

}  // namespace

SecondOrder second_order(const MatrixXd& A) {
  SecondOrder result;
  const auto list = pairs(A);
  const auto n = static_cast<Eigen::Index>(list.size());
  if (n == 0 || !A.allFinite()) return result;
  MatrixXd K(n, n), Z(n, n);
  for (const auto& [q, v] : list) {
    result.q.push_back(q);
    result.qdot.push_back(v);
  }
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto [q, v] = list[static_cast<std::size_t>(j)];
      K(i, j) = -A(list[static_cast<std::size_t>(i)].second, q);
      Z(i, j) = -A(list[static_cast<std::size_t>(i)].second, v);
    }
  const VectorXd d2 = symmetrizer(K);
  if (d2.size() == 0) return result;
  result.d = d2.cwiseSqrt();
  const MatrixXd S = result.d.cwiseInverse().asDiagonal() * K * result.d.asDiagonal();
  result.Z = result.d.cwiseInverse().asDiagonal() * Z * result.d.asDiagonal();
  VectorXd size = S.diagonal().cwiseAbs().cwiseSqrt();
  result.asymmetry = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const double scale = size(i) * size(j);
      const double off = std::abs(S(i, j) - S(j, i));
      if (off > 0) result.asymmetry = std::max(result.asymmetry, scale > 0 ? off / scale : 1);
    }
  result.S = (S + S.transpose()) / 2;
  result.skew = (S - S.transpose()) / 2;
  result.found = result.asymmetry <= 1e-9;
  return result;
}

namespace {

std::string block_of(const std::string& state) { return state.substr(0, state.rfind('.')); }

Pole make_pole(std::complex<double> s, bool pair) {
  Pole p;
  p.s = s;
  p.pair = pair;
  p.omega = std::abs(s);
  p.hertz = p.omega / (2 * std::numbers::pi);
  p.damping = p.omega > 0 ? -s.real() / p.omega + 0.0 : 0;
  return p;
}

void set_blocks(Pole& pole, const StateSpace& model, const VectorXd& share) {
  std::map<std::string, double> sum;
  for (Eigen::Index i = 0; i < share.size(); ++i)
    sum[block_of(model.states[static_cast<std::size_t>(i)])] += share(i);
  const double total = share.sum();
  for (const auto& [name, value] : sum)
    if (total > 0 && value >= 0.05 * total) pole.blocks.emplace_back(name, value / total);
  std::stable_sort(pole.blocks.begin(), pole.blocks.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
}

/// Poles of yddot + z ydot + w2 y = 0: a pair, or two real ones, the slow one by their product.
std::vector<Pole> roots(double w2, double z) {
  const double half = z / 2, omega = std::sqrt(std::max(w2, 0.0));
  const double root2 = w2 > 0 ? (half - omega) * (half + omega) : half * half - w2;
  if (root2 < 0) return {make_pole({-half, std::sqrt(-root2)}, true)};
  const double fast = -(half + std::copysign(std::sqrt(root2), half));
  return {make_pole(fast != 0 ? w2 / fast : 0, false), make_pole(fast, false)};
}

/// Poles of yddot + Z ydot + S y = 0 if Z is diagonal in the modes of S; false if it is not, or
/// if they show that S is not symmetric.
bool proportional_poles(const StateSpace& model, const SecondOrder& form, std::vector<Pole>& out) {
  const GradedModes all = eigh_graded(form.S);
  const std::optional<VectorXd> Z = diagonal_in(all, form.Z);
  if (!Z || !symmetric_in(all, form.S, form.skew)) return false;
  const auto& [lambda, V] = all.modes;
  for (Eigen::Index k = 0; k < lambda.size(); ++k) {
    VectorXd share = VectorXd::Zero(model.A.rows());
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      share(form.q[static_cast<std::size_t>(i)]) = V(i, k) * V(i, k);
    for (Pole& p : roots(lambda(k), (*Z)(k))) {
      set_blocks(p, model, share);
      out.push_back(std::move(p));
    }
  }
  return true;
}

void general_poles(const StateSpace& model, std::vector<Pole>& out) {
  const linalg::Eigensystem e = linalg::eigensystem(model.A);
  for (Eigen::Index k = 0; k < e.values.size(); ++k) {
    if (e.values(k).imag() < 0) continue;
    Pole p = make_pole(e.values(k), e.values(k).imag() > 0);
    set_blocks(p, model, e.V.col(k).cwiseProduct(e.W.row(k).transpose()).cwiseAbs());
    out.push_back(std::move(p));
  }
}

/// States that no state depends on through A, or that depend on no state (a free hinge's angle,
/// then its rate; an integrator): exact poles at A(j, j), mostly 0, that a numerical eigenvalue
/// routine would smear. Takes them out of the model, one after the other.
void deflate(StateSpace& m, std::vector<Pole>& out) {
  for (bool found = true; found;) {
    found = false;
    for (Eigen::Index j = 0; j < m.A.rows() && !found; ++j) {
      const auto zero_but = [&](const auto& line) {
        for (Eigen::Index i = 0; i < line.size(); ++i)
          if (i != j && line(i) != 0) return false;
        return true;
      };
      if (!zero_but(m.A.col(j)) && !zero_but(m.A.row(j))) continue;
      found = true;
      Pole p = make_pole(m.A(j, j), false);
      p.blocks.emplace_back(block_of(m.states[static_cast<std::size_t>(j)]), 1.0);
      out.push_back(std::move(p));
      std::vector<Eigen::Index> keep;
      for (Eigen::Index i = 0; i < m.A.rows(); ++i)
        if (i != j) keep.push_back(i);
      m.A = m.A(keep, keep).eval();
      m.states.erase(m.states.begin() + j);
    }
  }
}

}  // namespace

std::vector<Pole> poles(const StateSpace& model) {
  std::vector<Pole> result;
  StateSpace rest{model.A, {}, {}, {}, model.states, {}, {}};
  deflate(rest, result);
  std::vector<Pole> others;
  const SecondOrder form = second_order(rest.A);
  if (!form.found || !proportional_poles(rest, form, others)) {
    others.clear();
    if (rest.order() > 0) general_poles(rest, others);
  }
  result.insert(result.end(), others.begin(), others.end());
  std::stable_sort(result.begin(), result.end(), [](const Pole& a, const Pole& b) {
    return a.omega != b.omega ? a.omega < b.omega : a.s.real() < b.s.real();
  });
  return result;
}

std::string to_string(const std::vector<Pole>& list) {
  std::string text = fmt::format("{:>14} {:>14} {:>12}  {}\n", "rad/s", "Hz", "damping", "blocks");
  for (const Pole& p : list) {
    std::string blocks;
    for (const auto& [name, share] : p.blocks)
      blocks += fmt::format("{}{} {:.0f} %", blocks.empty() ? "" : ", ", name, 100 * share);
    text += fmt::format("{:>14.7g} {:>14.7g} {:>12.4g}  {}{}\n", p.omega, p.hertz, p.damping,
                        blocks, p.pair ? "" : "  (real)");
  }
  return text;
}

}  // namespace titop
