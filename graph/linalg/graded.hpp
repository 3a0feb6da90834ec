#pragma once

#include <optional>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop {

/// eigh for matrices graded as stiffness is, S = D G D with D diagonal over many decades and G well
/// conditioned: EVERY eigenvalue has a relative error of about eps * cond(G), vectors likewise,
/// where eigh(S) has errors of eps * lambda_max in all. Pivoted Cholesky S = L L' and Jacobi
/// rotations of the columns of L, until they are orthogonal [Demmel, Veselic 1992, "Jacobi's method
/// is more accurate than QR"]: six to nine sweeps of 3 n^3, five times the time of eigh. If a pivot
/// is below 1e-13 of its diagonal entry (rigid motions), it is eigh(S), and eigenvalues within
/// 1e-13 lambda_max of 0 are exactly 0. Throws as eigh.
struct GradedModes {
  SymmetricModes modes;
  bool graded = false;
  double relative = 0;  ///< relative error of eigenvalues, its order of magnitude: n eps over the
                        ///< least pivot by its diagonal entry; infinite if not graded
};
GradedModes eigh_graded(const Eigen::MatrixXd& S);

/// The diagonal of V'ZV (damping of each mode), or none if Z couples the modes: an off-diagonal
/// entry above 1e-12 of the terms of its sum; of modes that are not graded, above 1e-13 of the
/// largest entry. Entries below 1e-13 of their own terms (a rigid motion's) are 0. O(n^3).
std::optional<Eigen::VectorXd> diagonal_in(const GradedModes& of, const Eigen::MatrixXd& Z);

/// True if these modes of S are those of S + `skew`, too: in them the entries of the antisymmetric
/// `skew` are rounding (1e-12 of the terms of V'SV) or small compared with the modes' own (1e-9 of
/// sqrt(lambda_i lambda_j)). One that is neither may be small compared with the diagonal of S and
/// yet decide whether a slow mode is stable. O(n^3).
bool symmetric_in(const GradedModes& of, const Eigen::MatrixXd& S, const Eigen::MatrixXd& skew);

}  // namespace titop
