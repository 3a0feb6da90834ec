#pragma once

#include <titop/compiler/certificate/check.hpp>
#include <titop/compiler/certificate/residual.hpp>

namespace titop::detail {

/// Residual of the equations as written for one random input, and rounding of the outputs:
/// Certificate::residual, residual_where, at_instant, s, and a note if digits are lost. O(bodies),
/// and an LU of every different block without modes.
///
/// At one instant, by the factors themselves: the states are those of each single block at s,
/// for its inputs due to the direct effect of the input alone or, if these are 0 (behind a strictly
/// proper block), for inputs of size 1. Terms of an equation are then of like size unless the
/// diagram's own numbers are not. Also compares the blocks' own formula for s, used by transfers,
/// with A, B, C, D, for the first two of each type. With positions or rates in the equations,
/// dependent states or a reduced scene, and if digits may be lost, at one real s: all is then a
/// function of the input alone, but a second elimination is needed. Without inputs all
/// signals are 0 there: not checked.
void self_check(const Factored& data, Check& check);

}  // namespace titop::detail
