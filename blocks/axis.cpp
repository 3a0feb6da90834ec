#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <titop/blocks/axis.hpp>
#include <titop/graph/error.hpp>

namespace titop {

Axis about(const Vector3d& r, std::string name) {
  return {Axis::Kind::revolute, r, std::move(name)};
}

Axis along(const Vector3d& r, std::string name) {
  return {Axis::Kind::prismatic, r, std::move(name)};
}

Vector3d unit_direction(const Axis& axis) {
  const Vector3d& r = axis.direction;
  const double length = r.norm();
  if (!(length > 0) || !std::isfinite(length))
    throw Error(Code::bad_value,
                fmt::format("the axis ({}, {}, {}) has no direction", r.x(), r.y(), r.z()),
                "give a finite vector other than 0");
  return r / length;
}

std::pair<Vector3d, Vector3d> across(const Vector3d& a) {
  Eigen::Index farthest = 0;
  a.cwiseAbs().minCoeff(&farthest);
  const Vector3d e = Vector3d::Unit(farthest), b = (e - a * a.dot(e)).normalized();
  return {b, a.cross(b)};
}

Vector6 twist(const Axis& axis) {
  Vector6 s = Vector6::Zero();
  (axis.kind == Axis::Kind::prismatic ? s.head<3>() : s.tail<3>()) = unit_direction(axis);
  return s;
}

}  // namespace titop
