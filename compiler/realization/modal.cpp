#include <algorithm>
#include <cmath>
#include <titop/compiler/realization/modal.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

/// The coordinates with their rates; empty if a state is neither, or one is the rate of two.
std::vector<std::pair<int, int>> pairs(const StateSpace& model) {
  const std::vector<int> rates = rates_of(model);
  std::vector<char> is_rate(rates.size(), 0);
  std::vector<std::pair<int, int>> result;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    if (rates[i] < 0 || rates[at(rates[i])] >= 0) continue;
    if (is_rate[at(rates[i])]) return {};
    is_rate[at(rates[i])] = 1;
    result.emplace_back(i, rates[i]);
  }
  return 2 * result.size() == rates.size() ? result : std::vector<std::pair<int, int>>{};
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

SecondOrder second_order(const StateSpace& model) {
  const MatrixXd& A = model.A;
  SecondOrder result;
  const auto list = pairs(model);
  const auto n = static_cast<Eigen::Index>(list.size());
  if (n == 0 || !A.allFinite()) return result;
  MatrixXd K(n, n), Z(n, n);
  for (const auto& [q, v] : list) {
    result.q.push_back(q);
    result.qdot.push_back(v);
  }
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto [q, v] = list[at(j)];
      K(i, j) = -A(list[at(i)].second, q);
      Z(i, j) = -A(list[at(i)].second, v);
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

}  // namespace titop
