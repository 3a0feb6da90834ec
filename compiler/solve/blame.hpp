#pragma once

#include <titop/compiler/solve/joint.hpp>

namespace titop::solve {

/// What to tell the user about a joint system without a unique solution: `improper` where a
/// channel is inverted whose direct term alone is singular (a force on a massless point, a locked
/// point that the modes cannot move), `ill_posed` otherwise, with the loop's signals.
Mistake blame(const Stage& stage, const Joint& joint,
              const std::vector<std::shared_ptr<const Dynamics>>& blocks, const Health& health);

/// What leaves no acceleration free in these rows (of Stage::rows), as details and hint of an
/// `improper` mistake: the equation that imposes a force on a massless point, and why.
Mistake massless(const Stage& stage, const std::vector<int>& rows);

}  // namespace titop::solve
