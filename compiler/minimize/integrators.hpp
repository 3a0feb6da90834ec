#pragma once

#include <titop/graph/state_space.hpp>
#include <vector>

/// Integrators at the end of a model, which act on nothing but each other: positions and rates that
/// outputs read. For the compiler's own files.
namespace titop::modes {

/// The states of a model: those that act on one another, and those that only take.
struct Integrated {
  std::vector<int> rest, integrators;
};
/// A state is an integrator if it acts on nothing, or on integrators alone. O(n^2) per integrator.
Integrated find_integrators(const StateSpace& model);

/// The rest by itself. What goes into the integrators are outputs, after the model's own.
StateSpace without_integrators(const StateSpace& model, const Integrated& states);

/// `rest`, perhaps with fewer states than it had, with the integrators of the model again.
StateSpace with_integrators(const StateSpace& rest, const StateSpace& model,
                            const Integrated& states);

}  // namespace titop::modes
