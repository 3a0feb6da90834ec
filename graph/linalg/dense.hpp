#pragma once

#include <Eigen/Core>
#include <complex>
#include <titop/graph/linalg/similarity_scaling.hpp>

/// Dense solutions and eigenvalues with scaling and estimates of their conditioning.
namespace titop::linalg {

/// Solution of E z = F and estimates of its conditioning.
struct Solution {
  Eigen::MatrixXcd z;
  double rcond = 0;  ///< reciprocal condition number of the equilibrated E (1-norm estimate)
  double moved = 0;  ///< largest part of a column of z, equilibrated, that the refinement changed
};

/// Solves E z = F (n x n, n x m): rows and columns scaled by powers of two, LU with partial
/// pivoting, one step of refinement. rcond = 0 if a pivot is exactly 0. O(n^3).
Solution solve(const Eigen::MatrixXcd& E, const Eigen::MatrixXcd& F);

/// C (s - A)^-1 B + D to the last places of double: solved as by `solve`, then refined with
/// residuals in long double until no step changes more than the rounding of that, and summed in
/// long double. If the steps do not shrink, the factors are computed in long double, too. rcond = 0
/// and no z if a pivot is exactly 0. O(n^3).
Solution refined_response(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                          const Eigen::MatrixXd& C, const Eigen::MatrixXd& D,
                          std::complex<double> s);

/// Inverse of a square matrix and its reciprocal condition number; rcond = 0 if singular. O(n^3).
struct Inverse {
  Eigen::MatrixXd matrix;
  double rcond = 0;
};
Inverse inverse(const Eigen::MatrixXd& M);
/// The same after scaling of rows and columns by powers of two: rcond does not depend on the units
/// of states.
Inverse equilibrated_inverse(const Eigen::MatrixXd& M);

/// Eigenvalues of a real square matrix: of each of its parts separately, after a similarity scaling
/// by powers of two (linalg/similarity_scaling.hpp). O(n^3). Throws not_finite for entries that are
/// not; singular if the iteration does not converge.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

/// Eigenvalues with right vectors V (columns, norm 1) and left vectors W = V^-1 (rows).
struct Eigensystem {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd V, W;
  Eigen::VectorXd scale;  ///< the states' own sizes, by `scaling` (powers of two)
  double rcond_V = 0;     ///< reciprocal condition number of V: near 0 if A is near defective
};
/// `scaling`: similarity_scaling keeps small eigenvalues sharpest, similarity_scaling_of_parts the
/// coupling of parts.
Eigensystem eigensystem(const Eigen::MatrixXd& A,
                        Eigen::VectorXd (*scaling)(Eigen::MatrixXd&) = similarity_scaling);

}  // namespace titop::linalg
