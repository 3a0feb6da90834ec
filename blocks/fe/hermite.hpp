#pragma once

#include <Eigen/Core>

/// Cubic Hermite functions of one element: value and slope at its first end, then at its second.
/// For the folder's own files.
namespace titop::fe {

/// 420 / |a| times their mass matrix, and |a|^3 times that of their second derivatives, for an
/// element of length |a|; a negative a turns the sign of both slopes [Przemieniecki 1968, ch. 5].
Eigen::Matrix4d hermite_mass(double a);
Eigen::Matrix4d hermite_bending(double a);

/// Integrals over an element of length h; rows and columns are functions.
struct HermiteIntegrals {
  Eigen::Matrix4d values;      ///< of f f
  Eigen::Matrix4d slopes;      ///< of f' f'
  Eigen::Matrix4d curvatures;  ///< of f'' f''
  Eigen::Matrix4d mixed;       ///< of f'' (row) f (column)
};
HermiteIntegrals hermite_integrals(double h);

}  // namespace titop::fe
