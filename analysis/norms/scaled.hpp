#pragma once

#include <titop/graph/state_space.hpp>

/// Models as norms are computed from them.
namespace titop::detail {

/// Throws not_finite if an entry is not. `user`: "H2 norm", "zeros", for the message.
void require_finite(const StateSpace& model, const char* user);

/// The model in its states' own sizes, by powers of two. O(n^2).
StateSpace scaled(StateSpace model);

/// Rounding of the poles of a scaled model [rad/s]: that of A in the states' own sizes [G 7.2].
double rounding_of_poles(const StateSpace& scaled);

}  // namespace titop::detail
