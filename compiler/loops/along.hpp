#pragma once

#include <titop/compiler/loops/motion.hpp>
#include <vector>

namespace titop::loops {

/// The order in which the redundancy of chains is decided, independent of names. The first chain
/// comes first; next the chain that opens fewest columns (King's ordering), so that the front of
/// open columns stays narrow; chains that open none are inserted at once. Before each chain come
/// those that its loop contains. Of equals the first comes first. Returns places in `closings`.
/// O(entries log entries).
std::vector<int> along(const std::vector<Closing>& closings);

}  // namespace titop::loops
