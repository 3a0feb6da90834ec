#pragma once

#include <titop/compiler/stage.hpp>

namespace titop::passes {

/// Integrators for positions and rates that no state holds: once per assembly, as far as the
/// coefficients of those asked for may reach them.
void add_rigid_motions(Stage& stage, Graph& graph);

}  // namespace titop::passes
