#pragma once

#include <titop/compiler/passes/stage.hpp>

namespace titop::report {

/// The diagram as the user wrote it: without the Integrators that `lower` has added. O(graph).
Graph written(const Stage& stage);

}  // namespace titop::report
