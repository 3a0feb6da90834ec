#pragma once

#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/state_space.hpp>

namespace titop::detail {

/// A dense model and the rounding error of each of its entries.
struct Rounded {
  StateSpace model, rounding;
};

/// Rounding errors of the entries of a dense model of these sizes and names: the largest of four
/// samples by the factors. O(bodies * order).
StateSpace rounding_of(const Factored& data, const StateSpace& dense);

/// The dense model with 0 for every entry at rounding level: below about 30 times the factors'
/// rounding of a 0 there. Couplings at rounding level become exact zeros, in any units. Unchanged
/// if that costs the transfer digits. O(bodies * order), and, if entries become 0, some transfers
/// of a dense model; for models that `minimize` judges.
Rounded without_rounding(const Factored& data, StateSpace dense);

}  // namespace titop::detail
