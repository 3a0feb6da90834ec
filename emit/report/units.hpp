#pragma once

#include <string>
#include <titop/compiler/passes/stage.hpp>
#include <vector>

namespace titop::report {

/// A scalar input or output of the model.
struct ScalarSignal {
  std::string name;    ///< "W(3)"
  std::string signal;  ///< "W": its input or output in the diagram
  std::string unit;    ///< "N", "rad/s²"; empty: not known
  int index = 0;       ///< column of B or row of C
};

/// All inputs, or outputs, in the model's order, with the units that follow from the connected
/// ports: a wrench is [N; N m], an acceleration [m/s²; rad/s²], a hinge's angle [rad]. Unknown
/// behind a gain other than 1, and for signals between controllers. O(terms).
std::vector<ScalarSignal> scalar_inputs(const Stage& stage);
std::vector<ScalarSignal> scalar_outputs(const Stage& stage);

/// The ports that an input drives, and that an output reads: "hub.parent.force", "z1.stretch,
/// z3.stretch".
std::string drives(const Stage& stage, int input);
std::string reads(const Stage& stage, int output);

}  // namespace titop::report
