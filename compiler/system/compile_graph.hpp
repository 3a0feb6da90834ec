#pragma once

#include <memory>
#include <titop/compiler/system/system.hpp>

namespace titop::detail {

/// `compile` for a graph instead of a diagram: for the compiler's own files that rewrite graphs.
std::shared_ptr<const SystemData> compile_graph(const Graph& graph, const Options& options);

}  // namespace titop::detail
