#pragma once

#include <optional>
#include <titop/compiler/minreal/sampled.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Integrators at the end of a model, which act only on each other: positions and rates that
/// outputs read. For the compiler's own files.
namespace titop::minreal {

/// The states of a model: coupled ones, and integrators.
struct IntegratorSplit {
  std::vector<int> rest, integrators;
};
/// A state is an integrator if it acts on no state, or on integrators only. O(n^2) per integrator.
IntegratorSplit find_integrators(const StateSpace& model);

/// The rest without integrators. The integrators' inputs are outputs, after the model's own; if it
/// has none, after all states of the rest.
StateSpace without_integrators(const StateSpace& model, const IntegratorSplit& states);

/// `rest`, perhaps with fewer states than it had, with the integrators of the model again.
StateSpace with_integrators(const StateSpace& rest, const StateSpace& model,
                            const IntegratorSplit& states);

/// The same transfer as a sum: the rest, and the integrators separately.
struct Decoupled {
  Eigen::MatrixXd X;  ///< integrators = z + X rest, with zdot = N z + B u: the part without modes
  Eigen::MatrixXd N, B;
  Eigen::MatrixXd C_rest;  ///< of the rest, with its part in the integrators
};
/// The order of a model is that of both parts, since they have no pole in common: the rest must not
/// have one at 0. O(rest^3).
Decoupled decouple(const StateSpace& model, const IntegratorSplit& states);

/// The rest of a decoupled model; entries at rounding level are 0. None if the rest has a pole at 0
/// too (at_zero.hpp).
std::optional<StateSpace> decoupled_rest(const detail::Sampled& sampled,
                                         const IntegratorSplit& states);

}  // namespace titop::minreal
