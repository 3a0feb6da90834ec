#pragma once

#include <string>
#include <titop/graph/graph.hpp>
#include <titop/graph/linalg/kinematics.hpp>
#include <vector>

namespace titop::detail {

/// A point of known place, and its motion in space as a map of its channel's vector.
struct PlacedPoint {
  int channel = -1;
  Vector3d place = Vector3d::Zero();  ///< [m]
  Eigen::Matrix3Xd translation;       ///< 3 x size of the channel
  Eigen::Matrix3Xd rotation;
};

/// Places of the points of a lowered graph.
struct Places {
  std::vector<PlacedPoint> points;
  std::vector<std::string> notes;  ///< as ModeShapes::notes
};

/// By Block::kinematics at these values and by the equations between accelerations. O(points).
Places places(const Graph& graph, ParameterValues values);

}  // namespace titop::detail
