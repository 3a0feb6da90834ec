#pragma once

#include <titop/compiler/passes/stage.hpp>

namespace titop::passes {

/// Integrators for positions and rates that are no states: once per assembly, as far as the
/// coefficients of the terms that read them reach.
void add_rigid_motions(Stage& stage, Graph& graph);

}  // namespace titop::passes
