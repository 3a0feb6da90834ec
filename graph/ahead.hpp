#pragma once

#include <titop/graph/graph.hpp>

namespace titop {

/// Nodes are stored in the order in which passes visit them, their blocks anywhere in memory. Loops
/// over all nodes call this for each to prefetch the block of a later one.
inline void fetch_ahead(const Graph& graph, std::size_t node) {
  constexpr std::size_t kAhead = 8;
  if (node + kAhead < graph.nodes.size())
    __builtin_prefetch(graph.nodes[node + kAhead].block.get());
}

}  // namespace titop
