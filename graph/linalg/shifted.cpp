#include <algorithm>
#include <cmath>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/schur.hpp>
#include <titop/graph/linalg/shifted.hpp>

namespace titop::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

double largest_change(const MatrixXcd& change, const MatrixXcd& of) {
  double moved = 0;
  for (Index j = 0; j < of.cols(); ++j)
    if (const double size = of.col(j).norm(); size > 0)
      moved = std::max(moved, change.col(j).norm() / size);
  return moved;
}

}  // namespace

ShiftedSolver::ShiftedSolver(const MatrixXd& A, const MatrixXd& B)
    : n_(A.rows()), columns_(B.cols()) {
  for (std::vector<int>& states : uncoupled_parts(A)) {
    UncoupledPart p;
    p.A = A(states, states);
    p.B = B(states, Eigen::all);
    MatrixXd scaled = p.A;
    p.scale = similarity_scaling(scaled);
    Schur form = schur(scaled);
    p.T = std::move(form.T);
    p.Q = std::move(form.Q);
    p.R = p.Q.adjoint() * (p.scale.cwiseInverse().asDiagonal() * p.B);
    p.size = p.T.cwiseAbs().maxCoeff();
    p.states = std::move(states);
    parts_.push_back(std::move(p));
  }
}

Solution ShiftedSolver::solve(std::complex<double> s) const {
  Solution result{MatrixXcd(n_, columns_), 1, 0};
  double nearest = HUGE_VAL, farthest = 0;
  for (const UncoupledPart& part : parts_) {
    const Solution own = solve(part, s, nearest, farthest);
    if (own.z.size() == columns_ * std::ssize(part.states))
      result.z(part.states, Eigen::all) = own.z;
    result.rcond = std::min(result.rcond, own.rcond);
    result.moved = std::max(result.moved, own.moved);
  }
  if (farthest > 0) result.rcond = std::min(result.rcond, nearest / farthest);
  return result;
}

Solution ShiftedSolver::solve(const UncoupledPart& p, std::complex<double> s, double& nearest,
                              double& farthest) {
  const Index n = p.A.rows();
  MatrixXcd shifted = -p.T;
  shifted.diagonal().array() += s;
  const Eigen::VectorXd distance = shifted.diagonal().cwiseAbs();
  const double rounding = static_cast<double>(n) * kEpsilon * (p.size + std::abs(s));
  if (distance.minCoeff() > rounding) {
    const auto upper = shifted.triangularView<Eigen::Upper>();
    const MatrixXcd z = p.Q * upper.solve(p.R);
    MatrixXcd X = p.scale.asDiagonal() * z;
    const MatrixXcd residual = p.B - (s * X - p.A * X);
    const MatrixXcd scaled = p.scale.cwiseInverse().asDiagonal() * residual;
    const MatrixXcd change = p.Q * upper.solve(p.Q.adjoint() * scaled);
    const double moved = largest_change(change, z);
    // The error after a step of refinement is about the square of its change.
    if (moved <= kHalfDigits) {
      X += p.scale.asDiagonal() * change;
      nearest = std::min(nearest, distance.minCoeff());
      farthest = std::max(farthest, distance.maxCoeff());
      return {std::move(X), 1, moved};
    }
  }
  return linalg::solve(s * MatrixXcd::Identity(n, n) - p.A, p.B.cast<std::complex<double>>());
}

}  // namespace titop::linalg
