#pragma once

#include <set>
#include <titop/compiler/loops/lines.hpp>

/// Points immobilised by loop constraints.
namespace titop::loops {

/// Scalars that are 0 in every motion that the closed chains allow; prescribed motions are not
/// included.
using AtRest = std::set<ScalarColumn>;

/// Sets the motion of points that closed chains immobilise by their numbers to 0: the elimination
/// would find rounding instead of their accelerations. Closing equations, equations that place a
/// point, and bodies that `lower` has turned into equations keep their terms, which determine
/// forces. In all other equations and in outputs these motions are 0: bodies mounted there are on
/// the ground.
void hold_still(Stage& stage, const Motion& motion, const std::vector<Closing>& closings,
                const AtRest& held);

}  // namespace titop::loops
