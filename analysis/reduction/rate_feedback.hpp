#pragma once

#include <optional>
#include <string>
#include <titop/analysis/reduction/whole.hpp>
#include <titop/graph/graph.hpp>

/// Rotors in a structure: forces that follow rates, as a feedback around the structure at rest. For
/// the library's own files only.
namespace titop::detail {

/// A diagram whose gyroscopic torques and equations of dampers are taken out. Where they act it has
/// additional inputs w, forces dual to z (their power is w' z), and outputs z, the rates there,
/// after its own: the diagram as it was has w = -F z.
struct RateFeedback {
  Graph graph;
  Eigen::MatrixXd F;  ///< z x z: symmetric part semidefinite (dampers), the rest gyroscopic
  std::vector<std::string> ports;  ///< of every z: "w1.parent"
  std::string momenta;             ///< "40 N m s at w1.parent, ...", for the user; empty: all are 0
};

/// None for a diagram without rotors or momenta, or without forces that follow rates. Throws
/// NoStructure (bad_value) with the name of the force, if forces follow motions other than as
/// springs, dampers and gyroscopes. O(terms).
std::optional<RateFeedback> rate_feedback(const Graph& graph, ParameterValues values);

/// Scales the `unscaled` parts of the structure at rest so that w and z, its last inputs and
/// outputs, are reciprocal: their modal vectors b and c become equal. Parts that no w reaches stay.
/// O(n^3 + n^2 z).
void scale_masses(Coordinates& coordinates, const RateFeedback& feedback);

/// The whole of this diagram with its rates fed back: Z + P F P', P the modal vectors of w and z,
/// which are equal by reciprocity; motions without stiffness become mass-normalised first. Outputs
/// that accelerate with them are written so. Without the additional inputs and outputs. Throws
/// NoStructure, with the port, if w and z are not reciprocal to 1e-7. O(n^2 z).
void close(Whole& whole, const RateFeedback& feedback);

}  // namespace titop::detail
