#pragma once

#include <titop/graph/graph.hpp>

namespace titop::detail {

/// Takes these signals from the graph's list; all other indices are adapted, -1 for removed
/// ones. For the library's own files. O(graph).
void remove_signals(Graph& graph, const std::vector<char>& gone);

}  // namespace titop::detail
