#include <algorithm>
#include <limits>
#include <titop/graph/linalg/schur.hpp>
#include <titop/graph/linalg/shifted.hpp>

namespace titop::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// The error that is left after a step of refinement is about the square of its change: at most the
/// rounding unit.
constexpr double kMoved = 0x1p-26;

double largest_change(const MatrixXcd& change, const MatrixXcd& of) {
  double moved = 0;
  for (Index j = 0; j < of.cols(); ++j)
    if (const double size = of.col(j).norm(); size > 0)
      moved = std::max(moved, change.col(j).norm() / size);
  return moved;
}

}  // namespace

ShiftedSolver::ShiftedSolver(MatrixXd A, MatrixXd B) : A_(std::move(A)), B_(std::move(B)) {
  MatrixXd scaled = A_;
  scale_ = similarity_scaling(scaled);
  Schur form = schur(scaled);
  T_ = std::move(form.T);
  Q_ = std::move(form.Q);
  R_ = Q_.adjoint() * (scale_.cwiseInverse().asDiagonal() * B_);
  if (T_.size() > 0) size_ = T_.cwiseAbs().maxCoeff();
}

Solution ShiftedSolver::solve(std::complex<double> s) const {
  const Index n = A_.rows();
  if (n == 0) return {MatrixXcd(0, B_.cols()), 1, 0};
  MatrixXcd shifted = -T_;
  shifted.diagonal().array() += s;
  const Eigen::VectorXd distance = shifted.diagonal().cwiseAbs();
  const double rounding =
      static_cast<double>(n) * std::numeric_limits<double>::epsilon() * (size_ + std::abs(s));
  if (distance.minCoeff() > rounding) {
    const auto upper = shifted.triangularView<Eigen::Upper>();
    const MatrixXcd z = Q_ * upper.solve(R_);
    MatrixXcd X = scale_.asDiagonal() * z;
    const MatrixXcd residual = B_ - (s * X - A_ * X);
    const MatrixXcd scaled = scale_.cwiseInverse().asDiagonal() * residual;
    const MatrixXcd change = Q_ * upper.solve(Q_.adjoint() * scaled);
    const double moved = largest_change(change, z);
    if (moved <= kMoved) {
      X += scale_.asDiagonal() * change;
      return {std::move(X), distance.minCoeff() / distance.maxCoeff(), moved};
    }
  }
  return linalg::solve(s * MatrixXcd::Identity(n, n) - A_, B_.cast<std::complex<double>>());
}

}  // namespace titop::linalg
