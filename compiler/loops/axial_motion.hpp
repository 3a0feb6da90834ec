#pragma once

#include <set>
#include <string>
#include <titop/compiler/passes/stage.hpp>
#include <vector>

namespace titop::passes {

/// Names of those of these nodes that are flexible bodies of which no kept mode moves some child
/// point along the line from P to it; none if a node has no modes. O(nodes).
std::vector<std::string> without_axial_motion(const std::set<int>& nodes, const Stage& stage);

}  // namespace titop::passes
