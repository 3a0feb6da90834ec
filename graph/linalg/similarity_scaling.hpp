#pragma once

#include <Eigen/Core>
#include <vector>

namespace titop::linalg {

/// Diagonal similarity by powers of two that gives row and column i of A (n x n) equal norms, in
/// place: returns d with A_new = diag(d)^-1 A diag(d) (LAPACK's gebal) [Parlett, Reinsch 1969]. A
/// matrix with entries that are not finite is unchanged. O(n^2).
Eigen::VectorXd similarity_scaling(Eigen::MatrixXd& A);

/// Likewise, to the same result in all units of states and time, up to factors of about 2. States
/// that all act on one another: by the sweeps of `similarity_scaling`, which end early if units are
/// far apart, after a fit of logarithms [Curtis, Reid 1972]. Parts coupled in one direction only,
/// for which sweeps do not converge, are scaled so that the coupling entries are about as large as
/// the largest within either part: needed for vectors, not for eigenvalues. O(n^3 / 3).
Eigen::VectorXd similarity_scaling_of_parts(Eigen::MatrixXd& A);

/// Powers of two that bring all entries of M (m x n) other than 0 as near to 1 as rows and columns
/// can, by least squares of logarithms [Curtis, Reid 1972]: the scaled matrix is the same in all
/// units of rows and columns, up to factors of 4. Rows and columns of zeros keep their size.
/// O((m + n)^3 / 3).
struct TwoSidedScaling {
  Eigen::VectorXd row, column;  ///< diag(row) M diag(column) is the scaled matrix
};
TwoSidedScaling two_sided_scaling(const Eigen::MatrixXd& M);

/// Sets of states that all act on one another, directly or through others (the strong components of
/// A's pattern of entries other than 0): the eigenvalues of A are those of its parts. A part acts
/// only on those before it. O(n^2).
std::vector<std::vector<int>> parts(const Eigen::MatrixXd& A);

/// Sets of states that do not act on each other in either direction (the connected components of
/// the same pattern), each ascending, by their first states: A is block diagonal in this order.
/// O(n^2).
std::vector<std::vector<int>> uncoupled_parts(const Eigen::MatrixXd& A);

}  // namespace titop::linalg
