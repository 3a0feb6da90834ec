#pragma once

#include <Eigen/Core>

/// Symmetric eigenproblems, compiled once for double. Only the lower triangles of S, K and M are
/// read. Every eigenvector has the first of its entries of largest modulus positive, so that the
/// same matrices give the same signs. All of them throw `size` (not square, sizes differ) and
/// `not_finite`; a matrix that has to be positive definite and is not throws `singular` and names
/// the row.
namespace titop {

/// lambda ascending (N), one eigenvector per column of V (n x N).
struct SymmetricModes {
  Eigen::VectorXd lambda;
  Eigen::MatrixXd V;
};

/// S v = lambda v, V'V = I. S symmetric, n x n. Cost 9 n^3.
SymmetricModes eigh(const Eigen::MatrixXd& S);

/// K v = lambda M v, V'MV = I, all modes. K symmetric (free structures: semidefinite), M positive
/// definite, both n x n. Every lambda is off by some eps * lambda_max, so that the low ones of a
/// slender structure are lost: if K is definite take `eigh_definite`. Cost 14 n^3.
SymmetricModes eigh(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M);

/// The same, all modes, for K and M both positive definite: K = U_K'U_K, M = U_M'U_M, and the
/// singular values of U_K U_M^-1 are the omegas (lambda = omega^2). Working with omega instead of
/// its square halves the digits between the highest and the lowest mode: the low modes come out as
/// by `eigh_lowest`, the high ones as orthogonal as by `eigh(K, M)`, at twice the cost of the
/// latter. (Cantilever of 200 elements, lambda_max/lambda_1 = 5e11: first lambda 3e-8, V'MV - I
/// 3e-15.)
SymmetricModes eigh_definite(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M);

/// The same, the `count` lowest modes, for K positive definite and M semidefinite (massless degrees
/// of freedom): M v = mu K v, largest mu = 1/lambda first, then M-orthonormalised once, in
/// ascending order. Throws `bad_value` if fewer than `count` modes can be distinguished from
/// infinite ones. Cost 14 n^3.
SymmetricModes eigh_lowest(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M, Eigen::Index count);

/// First row whose Cholesky pivot is not above tolerance * S(row, row); -1 if there is none, that
/// is, S is positive definite by that margin. Does not depend on units. Cost n^3 / 3.
Eigen::Index weak_pivot(const Eigen::MatrixXd& S, double tolerance = 0.0);

/// K^-1 B by Cholesky (n x m), K positive definite. Throws `singular`. Cost n^3 / 3 + 2 n^2 m.
Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& K, const Eigen::MatrixXd& B);

}  // namespace titop
