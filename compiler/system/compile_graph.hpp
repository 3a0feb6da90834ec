#pragma once

#include <functional>
#include <memory>
#include <titop/compiler/passes/open/open.hpp>
#include <titop/compiler/passes/options.hpp>

namespace titop::detail {

struct SystemData;

/// `compile` for a graph instead of a diagram: for the compiler's own files that rewrite graphs.
std::shared_ptr<const SystemData> compile_graph(const Graph& graph, const Options& options);

/// All passes and the certificate from this stage on.
std::shared_ptr<const SystemData> compile_stage(Stage begin, const Options& options);

/// All passes on the stage that `rewrite` makes of the system's diagram at its present values:
/// Stage::source, values, motions and dependents, with the system's options, and minimized up to at
/// least this number of states. Cost: that of `compile`.
std::shared_ptr<const SystemData> compile_rewritten(
    const SystemData& data, const std::function<Stage(const Stage&)>& rewrite,
    int minimize_up_to = 0);

/// The system's diagram at its present values with these parameters taken out
/// (compiler/passes/open/open.hpp): their w are inputs after the diagram's own, their z outputs,
/// listed in Stage::opened. Its `update` runs all passes. Throws not_rational, also for a parameter
/// that moves closed chains, and the errors of `compile`. Cost: that of `compile`.
std::shared_ptr<const SystemData> compile_opened(const SystemData& data,
                                                 const std::vector<passes::ToOpen>& parameters);

}  // namespace titop::detail
