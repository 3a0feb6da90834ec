#pragma once

#include <titop/graph/graph.hpp>
#include <vector>

namespace titop::detail {

/// The graph with other blocks for some nodes (one entry per node, none: the node keeps its own),
/// of the same channels and ports in the same order, with or without states. Nodes, channels,
/// equations, inputs and outputs keep their places; signals move to make room for states. O(graph).
Graph with_blocks(Graph graph, const std::vector<BlockPtr>& blocks);

}  // namespace titop::detail
