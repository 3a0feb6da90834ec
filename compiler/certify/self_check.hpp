#pragma once

#include <titop/compiler/certify/residual.hpp>

namespace titop::detail {

/// How well the equations as written hold for one random input, and what rounding does to the
/// outputs: Certificate::residual, residual_where, at_instant, s, and a note where digits are lost.
/// O(bodies), and an LU of every different block without modes.
///
/// At one instant, by the factors themselves: the states are what each block, moved by itself at s,
/// would make of what the input alone moves at once, or, where that is nothing (behind what is
/// strictly proper), of inputs of size 1. Terms of an equation are then of like size unless the
/// diagram's own numbers are not. Beside it the blocks' own formula for s, which transfers are made
/// of, against A, B, C, D, for the first two of each type. With positions or rates in the
/// equations, states that follow from others or a reduced scene, and where digits may be lost, at
/// one real s: all is then a function of the input alone, but a second elimination is needed.
/// Without inputs nothing moves there: not checked.
void self_check(const SystemData& data, Check& check);

}  // namespace titop::detail
