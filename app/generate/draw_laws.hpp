#pragma once

#include "generate/dice.hpp"
#include "generate/plan.hpp"

/// Random matrices of controllers, with which no loop is singular.
namespace titop::generate {

/// Order 1 or 2, one input and one output; the law is that of `c`. Its contribution to the mass is
/// positive.
void draw_small_law(Dice& dice, Control& c);

/// Dense, of this order and of the size of `c.at`, entries of C up to `gain`. The symmetric part of
/// D is `direct`, which is positive. Of four one or two are stable, one is unstable, one has poles
/// at 0.
void draw_dense_law(Dice& dice, Control& c, int states, const Ratio& gain, const Ratio& direct);

}  // namespace titop::generate
