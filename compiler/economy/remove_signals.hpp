#pragma once

#include <titop/graph/graph.hpp>

namespace titop::detail {

/// Takes these signals from the graph's list; indices everywhere else follow, -1 where they meant
/// one of them. For the compiler's own files. O(graph).
void remove_signals(Graph& graph, const std::vector<char>& gone);

}  // namespace titop::detail
