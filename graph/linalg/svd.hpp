#pragma once

#include <Eigen/Core>

namespace titop::linalg {

/// M = U diag(sigma) V', thin: U and V have as many columns as the smaller side of M.
struct Svd {
  Eigen::MatrixXd U;
  Eigen::VectorXd sigma;  ///< descending
  Eigen::MatrixXd V;
};

/// The singular value decomposition, by bisection of the bidiagonal matrix (`BDCSVD`); if that
/// leaves more than rounding of the norm in M V - U diag(sigma), by Jacobi's rotations, at some ten
/// times the cost. (`BDCSVD` of Eigen 3.4.0 takes negative couplings for 0 where all are compared
/// with 0 at once: of 4,800 beams clamped at a node inside, 9 had wrong modes.) Throws singular if
/// the iteration does not converge. O(m n^2).
Svd svd(const Eigen::MatrixXd& M);

}  // namespace titop::linalg
