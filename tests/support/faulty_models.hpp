#pragma once

#include <optional>
#include <string>
#include <titop/graph/state_space.hpp>

#include "support/rng.hpp"

/// Models with a planted fault, and its effect on their transfer.
namespace titop_test {

struct FaultyModel {
  titop::StateSpace model;
  std::string fault;  ///< "A(3, 4)", "without hub.x"
};

/// A nonzero entry of A, B, C or D times 1 + 1e-4; with `dropping` one time in five a state is
/// dropped instead. Entries below 1e-9 of the largest of their matrix are left out: they may be
/// rounding. None if the matrix drawn has no entry.
std::optional<FaultyModel> with_fault(const titop::StateSpace& model, Rng& rng, bool dropping);

/// Largest change of an entry of the transfer over its largest value, at 200 points s = (0.05 + j)
/// w; in long double, by Gaussian elimination. Entries that are 0 up to rounding (below 1e-9 of
/// their terms |C| |(s - A)^-1 B| + |D|, or of their neighbours) do not count.
double change_of_transfer(const titop::StateSpace& right, const titop::StateSpace& faulty,
                          double lowest, double highest);

}  // namespace titop_test
