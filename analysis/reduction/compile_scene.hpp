#pragma once

#include <titop/analysis/reduction/reduced_system.hpp>

namespace titop::detail {

/// compile(diagram, scene) for a graph instead of a diagram. For the library's own files only.
ReducedSystem compile_scene(const Graph& graph, const Scene& scene, const Options& options);

}  // namespace titop::detail
