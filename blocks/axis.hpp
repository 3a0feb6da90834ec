#pragma once

#include <string>
#include <titop/graph/linalg/kinematics.hpp>
#include <utility>

namespace titop {

/// One degree of freedom of a joint: a rotation about r [rad] or a translation along r [m].
struct Axis {
  enum class Kind { revolute, prismatic };
  Kind kind = Kind::revolute;
  Vector3d direction = Vector3d::UnitZ();  ///< r, any length but 0
  std::string name = {};                   ///< of its ports and states; optional
};

/// A revolute axis: `about({0, 0, 1})`, `about({0, 0, 1}, "azimuth")`.
Axis about(const Vector3d& r, std::string name = {});
/// A prismatic axis: `along({1, 0, 0})`, `along({1, 0, 0}, "travel")`.
Axis along(const Vector3d& r, std::string name = {});

/// The unit vector along r. Throws bad_value if it has none.
Vector3d unit_direction(const Axis& axis);
/// Two unit vectors across the unit vector a, b x c = a: b is the coordinate axis farthest from a,
/// less its part along a.
std::pair<Vector3d, Vector3d> across(const Vector3d& a);
/// Its motion at value 1, (linear; angular): [r; 0] or [0; r], r a unit vector. Throws bad_value.
Vector6 twist(const Axis& axis);

}  // namespace titop
