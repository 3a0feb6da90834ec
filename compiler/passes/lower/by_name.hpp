#pragma once

#include <titop/graph/graph.hpp>

namespace titop::passes {

/// The same graph in an order that names decide, so that nothing after this depends on the order in
/// which the user wrote it: inputs and outputs in natural order of their names, nodes too, or along
/// the trees that they make, equations in the order of their targets. It
/// stands so in memory, too, since all passes after this go through it in turn.
Graph by_name(const Graph& graph);

}  // namespace titop::passes
