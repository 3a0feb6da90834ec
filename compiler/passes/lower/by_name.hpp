#pragma once

#include <titop/graph/graph.hpp>

namespace titop::passes {

/// The same graph with nodes, inputs and outputs in natural order of their names, so that nothing
/// after this depends on the order in which the user wrote them.
Graph by_name(Graph graph);

}  // namespace titop::passes
