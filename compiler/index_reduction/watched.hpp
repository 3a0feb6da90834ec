#pragma once

#include <titop/compiler/solve/factored.hpp>
#include <vector>

namespace titop::detail {

/// Marks, one per state of the blocks.
using StateMarks = std::vector<char>;

/// Marks the states that are read, by a coefficient that is not 0, in an output, a row of the joint
/// system, or the rate of a state that is read itself. (The twist of a spring without torsional
/// stiffness is not.) O(entries of the rows and blocks, times the longest chain of states).
StateMarks watched_states(const Skeleton& k, const Factored& d);

/// These states and all whose rates they enter, one after the other. Same cost.
StateMarks moved_with(const Skeleton& k, const Factored& d, StateMarks states);

}  // namespace titop::detail
