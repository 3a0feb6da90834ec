#pragma once

#include <Eigen/Core>
#include <optional>
#include <titop/compiler/realization/modal.hpp>
#include <titop/graph/linalg/graded.hpp>
#include <vector>

namespace titop {

/// Modes of a second-order form that damping does not couple: each is an oscillator
/// eta'' = -z eta' - lambda eta.
struct ProportionalModes {
  GradedModes undamped;  ///< y = V eta, by rising lambda [rad^2/s^2]
  Eigen::VectorXd z;     ///< 2 xi omega [rad/s] of each mode
};

/// Modes of one frequency are turned until damping does not couple them. None if damping couples
/// other modes (diagonal_in), or if the form is not symmetric in its modes (symmetric_in). O(n^3).
std::optional<ProportionalModes> proportional_modes(const SecondOrder& form);

/// Consecutive modes.
struct ModeRange {
  Eigen::Index first, count;
};

/// Modes, by rising lambda, whose frequencies are equal up to rounding and this part of lambda.
std::vector<ModeRange> equal_frequencies(const GradedModes& e, double same);

}  // namespace titop
