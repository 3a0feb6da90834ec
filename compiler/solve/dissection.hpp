#pragma once

#include <titop/compiler/solve/plan.hpp>

namespace titop::solve {

/// Nested dissection by level structures (A. George, J. W.-H. Liu, "An automatic nested dissection
/// algorithm for irregular finite element problems", SIAM J. Numer. Anal. 15, 1978): the variables
/// that share rows are divided by the middle level of a long breadth-first search, and both
/// parts again, down to a few variables. Returns each variable's rank in the order of elimination:
/// parts before their separators, 0 for the first. O(entries log variables) for rows of few
/// variables.
std::vector<int> dissection(const Structure& structure);

}  // namespace titop::solve
