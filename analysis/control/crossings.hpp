#pragma once

#include <titop/analysis/control/loop_response.hpp>
#include <titop/analysis/control/margins.hpp>

/// Crossings of one loop with the unit circle and the negative real axis. For the folder's own
/// files.
namespace titop::detail {

/// Where |L| = 1, by frequency, above 0.
std::vector<LoopCrossing> unit_crossings(const StateSpace& L, const LoopResponse& response);

/// Where L is real and negative, by frequency: 0 (if L has no pole there) and infinity (if it has a
/// direct term and no delay) included. With a delay: up to end_of_turns, beyond which L is smaller
/// than at one of these.
std::vector<LoopCrossing> negative_crossings(const StateSpace& L, const LoopResponse& response);

}  // namespace titop::detail
