#pragma once

#include <titop/compiler/definition/exact_order.hpp>
#include <titop/compiler/passes/stage.hpp>

namespace titop::minreal {

/// exact_order of the diagram as written. `states`: number of states after the passes, an upper
/// limit for closed chains: more would be due to rounding of the data, by which the chain does not
/// close.
ExactOrder order_of_stage(const Stage& stage, int states, const ExactOptions& options,
                          ParameterValues values);

}  // namespace titop::minreal
