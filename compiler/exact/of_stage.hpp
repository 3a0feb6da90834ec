#pragma once

#include <titop/compiler/exact_order.hpp>
#include <titop/compiler/stage.hpp>

namespace titop::exact {

/// exact_order of what the user wrote, of which `states` are left. Where chains close, more than
/// these are not taken for the truth: the last places of the data hold the chain open.
ExactOrder order_of_stage(const Stage& stage, int states, const ExactOptions& options,
                          ParameterValues values);

}  // namespace titop::exact
