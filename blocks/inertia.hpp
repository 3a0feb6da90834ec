#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <titop/graph/linalg/kinematics.hpp>
#include <titop/graph/value.hpp>
#include <vector>

namespace titop {

/// Inertia of a rigid body [kg m^2]: a 3 x 3 matrix, or its entries, each of which may be a
/// parameter. Blocks that use it check that a rigid body can have it.
///
///     .inertia = Vector3d(9, 11, 13).asDiagonal()
///     .inertia = {J, J, 2.0 * J}                    // principal moments: xx, yy, zz
///     .inertia = {20, 25, J, 0, -1.5, 0}            // xx, yy, zz, xy, xz, yz
///
/// xy, xz and yz are entries of the matrix: xy = - integral of x y dm. O(1), 200 bytes more if
/// it has parameters.
class Inertia {
 public:
  /// Throws size for a matrix that is not 3 x 3.
  template <class M>
  Inertia(const Eigen::EigenBase<M>& matrix) {
    check_size(matrix.rows(), matrix.cols());
    matrix_ = matrix.derived();
  }
  Inertia(Value xx, Value yy, Value zz, Value xy = 0, Value xz = 0, Value yz = 0);

  /// 3 x 3, for these parameter values.
  Matrix3d at(ParameterValues values) const;
  /// Parameters at their nominal values.
  Matrix3d nominal() const { return matrix_; }
  /// xx, yy, zz, xy, xz, yz; empty if none is a parameter.
  std::vector<Value> values() const;

 private:
  static void check_size(Eigen::Index rows, Eigen::Index cols);

  Matrix3d matrix_;
  std::shared_ptr<const std::array<Value, 6>> entries_;  ///< only with parameters
};

}  // namespace titop
