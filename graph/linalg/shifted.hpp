#pragma once

#include <titop/graph/linalg/dense.hpp>

namespace titop::linalg {

/// (s - A) X = B for many s, by one complex Schur form of A after a similarity scaling by powers of
/// two: O(25 n^3) once, then O(n^2 m) per s in place of the O(n^3) of `solve`. Faster
/// from 4 to 7 points on, for 16 to 100 states.
class ShiftedSolver {
 public:
  /// A n x n, B n x m. Throws not_finite; singular if the eigenvalue iteration does not converge.
  ShiftedSolver(Eigen::MatrixXd A, Eigen::MatrixXd B);

  /// X with one step of refinement. If that changes a column by more than 2^-26 of it, or s is an
  /// eigenvalue to rounding, by `solve`: rcond and moved are then of its factors. Otherwise rcond
  /// is the least over the largest distance of s to an eigenvalue.
  Solution solve(std::complex<double> s) const;

 private:
  Eigen::MatrixXd A_, B_;
  Eigen::VectorXd scale_;   ///< of the states
  Eigen::MatrixXcd T_, Q_;  ///< Schur form of diag(scale)^-1 A diag(scale)
  Eigen::MatrixXcd R_;      ///< Q^H diag(scale)^-1 B
  double size_ = 0;         ///< largest entry of T
};

}  // namespace titop::linalg
