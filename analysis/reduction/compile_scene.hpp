#pragma once

#include <titop/analysis/reduction/reduction.hpp>

namespace titop::detail {

/// compile(diagram, scene) for a graph instead of a diagram: Order::nested as `compile`, or the
/// least order, as `reduce_beams`. For the library's own files only.
ReducedSystem compile_scene(const Graph& graph, const Scene& scene, const Options& options,
                            Order order);

}  // namespace titop::detail
