#include <algorithm>
#include <cmath>
#include <titop/compiler/minreal/take_out.hpp>
#include <titop/compiler/minreal/to_order.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <titop/graph/name_order.hpp>

namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Every column of the norm 1, or 0.
MatrixXd with_unit_columns(MatrixXd M) {
  for (Index j = 0; j < M.cols(); ++j)
    if (const double norm = M.col(j).norm(); norm > 0) M.col(j) /= norm;
  return M;
}

/// Orthonormal basis of the span of B, A B, A^2 B, ...; A's norm and those of B's columns are 1.
/// (The staircase of clusters, minreal/staircase.hpp, decides by rounding that grows from step to
/// step; here the order is known, and by it 18 of 4,326 random models stay too large in place
/// of 2.)
MatrixXd krylov_basis(const MatrixXd& A, const MatrixXd& B, double tolerance) {
  const Index n = A.rows();
  MatrixXd Q(n, 0), next = B;
  while (next.cols() > 0 && Q.cols() < n) {
    for (int twice = 0; twice < 2; ++twice) next -= Q * (Q.transpose() * next).eval();
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(next);
    const VectorXd own = qr.matrixQR().diagonal().cwiseAbs();
    const Index rank = (own.array() > tolerance).count();
    const MatrixXd found = qr.householderQ() * MatrixXd::Identity(n, rank);
    Q.conservativeResize(Eigen::NoChange, Q.cols() + rank);
    Q.rightCols(rank) = found;
    next = A * found;
  }
  return Q;
}

/// Rows of a basis: `out` are T times the others.
struct DependentRows {
  std::vector<int> out;
  MatrixXd T;
};

DependentRows dependent_rows(const MatrixXd& Q, const VectorXd& unit) {
  const Index n = Q.rows(), r = Q.cols();
  DependentRows result;
  if (r == 0) {
    for (int i = 0; i < n; ++i) result.out.push_back(i);
    result.T = MatrixXd(n, 0);
    return result;
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(Q.transpose());
  for (Index k = r; k < n; ++k)
    result.out.push_back(static_cast<int>(qr.colsPermutation().indices()(k)));
  std::sort(result.out.begin(), result.out.end());
  const std::vector<int> keep = others(n, result.out);
  const MatrixXd kept = Q(keep, Eigen::all).transpose(),
                 left = Q(result.out, Eigen::all).transpose();
  const MatrixXd T = Eigen::CompleteOrthogonalDecomposition<MatrixXd>(kept).solve(left).transpose();
  result.T = unit(result.out).asDiagonal() * T * unit(keep).cwiseInverse().asDiagonal();
  return result;
}

/// Takes out the states that no input moves, or no output sees.
void take_out_side(StateSpace& m, bool by_inputs, double tolerance,
                   std::vector<std::string>& notes) {
  if (m.A.rows() == 0) return;
  MatrixXd scaled = m.A;
  const VectorXd size = linalg::similarity_scaling_of_parts(scaled);
  const VectorXd unit = by_inputs ? size : VectorXd(size.cwiseInverse());
  const MatrixXd A = by_inputs ? scaled : MatrixXd(scaled.transpose());
  const MatrixXd ports = by_inputs ? m.B : MatrixXd(m.C.transpose());
  const double norm = A.norm();
  const MatrixXd Q =
      krylov_basis(norm > 0 ? MatrixXd(A / norm) : A,
                   with_unit_columns(unit.cwiseInverse().asDiagonal() * ports), tolerance);
  const DependentRows rows = dependent_rows(Q, unit);
  if (rows.out.empty()) return;
  notes.push_back(by_inputs ? note_of_dependent(m, rows.out) : note_of_unseen(m, rows.out));
  if (by_inputs)
    take_out_dependent(m, rows.out, rows.T);
  else
    take_out_unseen(m, rows.out, rows.T.transpose());
}

}  // namespace

namespace {

std::optional<ModelOfOrder> to_order_as_listed(const StateSpace& model, int order) {
  for (int power = -16; power <= -6; ++power) {
    ModelOfOrder result{model, {}, std::pow(10, power)};
    take_out_side(result.model, true, result.tolerance, result.notes);
    take_out_side(result.model, false, result.tolerance, result.notes);
    if (result.model.order() == order) return result;
    if (result.model.order() < order) break;
  }
  return {};
}

}  // namespace

std::optional<ModelOfOrder> to_order(const StateSpace& model, int order) {
  const std::optional<NameOrder> names = name_order(model);
  if (!names) return to_order_as_listed(model, order);
  std::optional<ModelOfOrder> result = to_order_as_listed(by_name(model, *names), order);
  if (result) result->model = as_before(result->model, model.states, *names);
  return result;
}

}  // namespace titop::minreal
