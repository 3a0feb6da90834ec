#pragma once

#include <titop/compiler/system_data.hpp>

namespace titop::detail {

constexpr double kWarn = 1e-9;  ///< what is worse than this is said in the log

/// How well the equations as written hold for one random input, and what rounding does to the
/// outputs: Certificate::residual, residual_where, s, and a note where digits are lost. O(bodies).
///
/// Where every signal follows from states and inputs, at one instant and by the factors themselves:
/// the states are what each block, moved by itself at s, would make of what the input alone moves
/// at once, so that no term of an equation hides behind another. With positions or rates in the
/// equations, dependent states or a reduced scene, and wherever that instant leaves a doubt, at one
/// real s: the signals are then functions of the input alone, but a second elimination is needed.
void self_check(const SystemData& data, Check& check);

}  // namespace titop::detail
