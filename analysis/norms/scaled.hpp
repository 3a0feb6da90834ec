#pragma once

#include <titop/graph/state_space.hpp>

/// Models as norms are computed from them.
namespace titop::detail {

/// The model in its states' own sizes, by powers of two. O(n^2).
StateSpace scaled(StateSpace model);

/// Rounding of the poles of a scaled model [rad/s]: that of A in the states' own sizes [G 7.2].
double rounding_of_poles(const StateSpace& scaled);

}  // namespace titop::detail
