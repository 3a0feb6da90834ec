#pragma once

#include <titop/compiler/solve/joint.hpp>

namespace titop::solve {

/// What to tell the user about a joint system without a unique solution: `improper` where a
/// channel is inverted whose direct term alone is singular (a force on a massless point, a locked
/// point that the modes cannot move), `ill_posed` otherwise, with the loop's signals.
Mistake blame(const Stage& stage, const Joint& joint,
              const std::vector<std::shared_ptr<const Dynamics>>& blocks, const Health& health);

}  // namespace titop::solve
