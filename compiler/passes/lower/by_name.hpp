#pragma once

#include <titop/compiler/passes/stage.hpp>
#include <titop/graph/graph.hpp>

namespace titop::passes {

/// The same graph in an order decided by names, so that no later result depends on the order in
/// which the user wrote it: inputs and outputs in natural order of their names, nodes too, or along
/// the trees that they form, equations in the order of their targets. The order in memory is the
/// same, since all later passes traverse it in turn.
Graph by_name(const Graph& graph);

/// The same for the graph of a stage: indices of nodes and signals in Stage::motions and
/// Stage::before, from a compiled system whose graph has been rewritten, are renumbered.
Graph by_name(const Graph& graph, Stage& stage);

}  // namespace titop::passes
