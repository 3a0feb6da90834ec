#pragma once

#include <titop/graph/graph.hpp>
#include <vector>

namespace titop::passes {

/// The given order of the nodes; but where the couplings make trees, as a walk meets them that goes
/// depth first, from the first of that order to the last: passes look from a node to its
/// neighbours, which then lie near. Where chains close, through the ground too, the given order
/// alone decides, for which states stay depends on it. O(nodes + terms).
std::vector<int> along_trees(const Graph& graph, std::vector<int> order);

}  // namespace titop::passes
