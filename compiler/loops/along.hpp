#pragma once

#include <titop/compiler/loops/motion.hpp>
#include <vector>

namespace titop::loops {

/// The order in which the redundancy of chains is decided: each after those that its loop contains,
/// and next to chains with common bodies or joints, so that few columns are open between decided
/// chains and later ones, independent of names. Starts with the first, continues with the chain
/// that opens fewest columns (King's order of a front), and inserts chains that open none; of
/// equals the first comes first. Returns places in `closings`. O(entries log entries).
std::vector<int> along(const std::vector<Closing>& closings);

}  // namespace titop::loops
