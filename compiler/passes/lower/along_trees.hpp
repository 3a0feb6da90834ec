#pragma once

#include <titop/graph/graph.hpp>
#include <vector>

namespace titop::passes {

/// The given order of the nodes, or, if the couplings are trees, their depth-first order, starting
/// from the first of the given order: passes look from a node to its neighbours, which are then
/// near in memory. If chains close, also through the ground, the given order is kept, since the
/// choice of states depends on it. O(nodes + terms).
std::vector<int> along_trees(const Graph& graph, std::vector<int> order);

}  // namespace titop::passes
