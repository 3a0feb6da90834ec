#pragma once

#include <Eigen/Core>
#include <vector>

/// The complex Schur form of a real matrix, and linear matrix equations solved by it.
namespace titop::linalg {

/// A = Q T Q^H, T upper triangular, Q unitary (n x n); the eigenvalues are T's diagonal.
struct Schur {
  Eigen::MatrixXcd T, Q;
};

/// Schur form of a real square matrix: the real form [Francis], its 2 x 2 blocks turned to
/// triangles. Throws not_finite, and singular if the iteration does not converge. O(25 n^3).
Schur schur(const Eigen::MatrixXd& A);

/// Brings the marked eigenvalues to the front, in their order, by rotations of neighbours: the
/// first columns of Q then span their invariant subspace. O(n) per exchange.
void reorder(Schur& schur, std::vector<char> first);

/// A X - X B = C for upper triangular A (m x m) and B (n x n) without a common eigenvalue, C m x n.
/// O(m n (m + n)).
Eigen::MatrixXcd sylvester(const Eigen::MatrixXcd& A, const Eigen::MatrixXcd& B,
                           const Eigen::MatrixXcd& C);

/// Upper triangular U (n x n) with P = U U^H the solution of T P + P T^H + B B^H = 0, T upper
/// triangular with eigenvalues left of the axis, B n x m: the factor is computed without forming P,
/// so that small parts of P keep their digits [Hammarling 1982]. O(n^3 / 3 + n^2 m).
Eigen::MatrixXcd lyapunov_factor(const Eigen::MatrixXcd& T, const Eigen::MatrixXcd& B);

}  // namespace titop::linalg
