#pragma once

#include <set>
#include <titop/compiler/passes/close/lines.hpp>

/// What closed chains hold altogether: points that cannot move though nothing says so.
namespace titop::passes::closing {

/// Scalars that are 0 in every motion that the closed chains leave; what the equations prescribe is
/// none.
using AtRest = std::set<Scalar>;

/// Points that closed chains hold by their numbers: the elimination would find rounding in place of
/// their accelerations. The chains' own equations need them, for the forces, and so do bodies that
/// `lower` has turned into equations; whatever else reads one reads nothing, so that outputs are 0
/// and what hangs there stands on the ground.
void hold_still(Stage& stage, const Motion& motion, const std::vector<Closing>& closings,
                const AtRest& held);

}  // namespace titop::passes::closing
