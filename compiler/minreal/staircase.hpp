#pragma once

#include <Eigen/Core>
#include <titop/compiler/certificate/residual.hpp>

/// The minimal part of a small model whose poles are one cluster, by orthogonal transformations.
/// For the compiler's own files.
namespace titop::minreal {

inline constexpr double kClearly = 1e4;  ///< times rounding: certainly larger
/// The accuracy that is promised: above it, of the visibility of a mode, or of a rank's rounding
/// relative to its size, nothing is removed.
using detail::kWarn;

/// xdot = A x + B u, y = C x, and the bound of its rounding.
struct ClusterModel {
  Eigen::MatrixXd A, B, C;  ///< k x k, k x nu, ny x k; nu = 0 or ny = 0: that side counts fully
  double A_noise = 0;       ///< norm
  Eigen::VectorXd B_noise;  ///< norm of each column
  Eigen::VectorXd C_noise;  ///< norm of each row
  double A_size = 0;        ///< norm of the matrix that A is a part of
  Eigen::VectorXd B_size, C_size;  ///< likewise of each input and output
};

/// The minimal part of a cluster.
struct MinimalPart {
  Eigen::MatrixXd unreachable;  ///< k x u, orthonormal: unreachable' x stays 0
  Eigen::MatrixXd unseen;       ///< k x v: of the others, unobservable motions
  /// Least number of states that would suffice if all possible rounding (up to 1e4 times its bound)
  /// were 0.
  Eigen::Index lowest = 0;
  double visibility = 0;  ///< largest part of a column, row or A that was taken for 0
  double bound = 0;       ///< rounding's in the same units
  Eigen::Index order(Eigen::Index k) const { return k - unreachable.cols() - unseen.cols(); }
};

/// Controllability and then observability staircase [Van Dooren 1981]. A rank is that of the part
/// above 32 times rounding, which grows with each step by the uncertain angle of the one before. If
/// rounding is more than 1e-9 of the sizes, nothing is removed. O(k^4).
MinimalPart minimal_part(const ClusterModel& model);

}  // namespace titop::minreal
