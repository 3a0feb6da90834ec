#pragma once

#include <titop/compiler/solve/joint.hpp>

namespace titop::solve {

/// The mistake of rows (of Stage::rows) that depend on one another and determine no state:
/// `improper` if one of them inverts a channel whose direct term alone is singular (a force on a
/// massless body, a locked point that the modes cannot move), `ill_posed` otherwise. `rows` is
/// minimal: without any one of them, the others are independent. `inputs`: those that they would
/// make 0.
Mistake blame(const Stage& stage, const std::vector<std::shared_ptr<const Dynamics>>& blocks,
              const std::vector<int>& rows, const std::vector<int>& inputs);

/// Names the ports whose numbers have overflowed (Health::finite).
Mistake overflow(const Stage& stage, const JointSystem& joint, const Health& health);

/// The reason why no acceleration is free in these rows (of Stage::rows), as details and hint of an
/// `improper` mistake: the equation that imposes a force on a massless point, and why.
Mistake massless(const Stage& stage, const std::vector<int>& rows);

}  // namespace titop::solve
