#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <titop/graph/linalg/kinematics.hpp>
#include <titop/graph/value.hpp>
#include <vector>

namespace titop {

/// A point's place in the frame of a body [m]: a vector of 3, or its components, each of which may
/// be a parameter.
///
///     .PA = Vector3d(0.1, 0, 0.2)
///     .children = {{"tip", {length, 0, 0}}}         // auto length = d.param("length", 4.0)
///
/// O(1), 200 bytes more if it has parameters.
class Position {
 public:
  Position() = default;  ///< 0
  /// Throws size for a matrix that is not 3 x 1.
  template <class M>
  Position(const Eigen::EigenBase<M>& vector) {
    check_size(vector.rows(), vector.cols());
    vector_ = vector.derived();
  }
  Position(Value x, Value y, Value z);

  Vector3d at(ParameterValues values) const;
  /// Parameters at their nominal values.
  const Vector3d& nominal() const { return vector_; }
  /// x, y, z; empty if none is a parameter.
  std::vector<Value> values() const;

 private:
  static void check_size(Eigen::Index rows, Eigen::Index cols);

  Vector3d vector_ = Vector3d::Zero();
  std::shared_ptr<const std::array<Value, 3>> components_;  ///< only with parameters
};

}  // namespace titop
