#pragma once

#include <titop/graph/graph.hpp>

namespace titop {

/// Nodes stand in the order in which passes visit them, their blocks wherever the user's code made
/// them. Whoever goes through all nodes calls this for each, and the block of a later one is on its
/// way from memory while this one is worked on.
inline void fetch_ahead(const Graph& graph, std::size_t node) {
  constexpr std::size_t kAhead = 8;
  if (node + kAhead < graph.nodes.size())
    __builtin_prefetch(graph.nodes[node + kAhead].block.get());
}

}  // namespace titop
