#pragma once

#include <titop/graph/graph.hpp>

namespace titop::loops {

/// False if no two points are tied twice, directly or through bodies, joints or the ground, and
/// nothing is integrated: then no kinematic chain closes, and no integral repeats another. By
/// disjoint sets of points, without geometry. O(points).
bool may_close(const Graph& graph, ParameterValues values);

}  // namespace titop::loops
