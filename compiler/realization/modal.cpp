#include <algorithm>
#include <cmath>
#include <titop/compiler/realization/modal.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

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

/// Sets S, skew, asymmetry and found.
void set_stiffness(const MatrixXd& S, SecondOrder& form) {
  const VectorXd size = S.diagonal().cwiseAbs().cwiseSqrt();
  form.asymmetry = 0;
  for (Eigen::Index i = 0; i < S.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const double scale = size(i) * size(j);
      const double off = std::abs(S(i, j) - S(j, i));
      if (off > 0) form.asymmetry = std::max(form.asymmetry, scale > 0 ? off / scale : 1);
    }
  form.S = (S + S.transpose()) / 2;
  form.skew = (S - S.transpose()) / 2;
  form.found = form.asymmetry <= linalg::kMatrixDigits;
}

void by_diagonal(const MatrixXd& K, const MatrixXd& Z, SecondOrder& form) {
  const VectorXd d2 = symmetrizer(K);
  if (d2.size() == 0) return;
  const VectorXd d = d2.cwiseSqrt(), inverse = d.cwiseInverse();
  form.D = d.asDiagonal();
  form.D_inverse = inverse.asDiagonal();
  form.Z = inverse.asDiagonal() * Z * d.asDiagonal();
  set_stiffness(inverse.asDiagonal() * K * d.asDiagonal(), form);
}

/// E = L L', y = L' q.
void by_energy(const MatrixXd& K, const MatrixXd& Z, const MatrixXd& energy, SecondOrder& form) {
  const Eigen::LLT<MatrixXd> factors(energy(form.q, form.q));
  if (factors.info() != Eigen::Success) return;
  form.D_inverse = factors.matrixU();
  form.D = factors.matrixU().solve(MatrixXd::Identity(K.rows(), K.cols()));
  form.Z = form.D_inverse * Z * form.D;
  set_stiffness(form.D_inverse * K * form.D, form);
}

}  // namespace

SecondOrder second_order(const StateSpace& model, const MatrixXd& energy) {
  const MatrixXd& A = model.A;
  SecondOrder result;
  const auto list = pairs(model);
  if (list.empty() || !A.allFinite()) return result;
  for (const auto& [q, v] : list) {
    result.q.push_back(q);
    result.qdot.push_back(v);
  }
  const MatrixXd K = -A(result.qdot, result.q), Z = -A(result.qdot, result.qdot);
  by_diagonal(K, Z, result);
  if (!result.found && energy.rows() == A.rows()) by_energy(K, Z, energy, result);
  return result;
}

}  // namespace titop
