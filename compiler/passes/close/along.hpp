#pragma once

#include <titop/compiler/passes/close/motion.hpp>
#include <vector>

namespace titop::passes::closing {

/// The chains, in an order in which to decide what they say twice: each after those that its way
/// round goes through, and side by side where they share bodies or joints, so that few columns are
/// open between those that are decided and those to come, whatever the names. Starts with the
/// first, goes on where fewest columns are opened (King's order of a front), and takes in between
/// whatever opens none; of equals the first comes first. Returns places in `closings`. O(entries
/// log entries).
std::vector<int> along(const std::vector<Closing>& closings);

}  // namespace titop::passes::closing
