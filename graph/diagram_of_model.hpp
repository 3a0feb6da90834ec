#pragma once

#include <string>
#include <titop/graph/diagram.hpp>
#include <titop/graph/state_space.hpp>

namespace titop {

/// A diagram of this model alone: an Lti "model" with the model's inputs and outputs by name. So a
/// reduced model gets the functions of a System: generated code, margins, simulation, a report.
/// Compile it with Options{.minimize_up_to = 0} to keep all of its states, which become "model.x1"
/// and so on. Throws size for matrices that do not fit each other or the names of inputs and
/// outputs, not_finite; `compile` reports duplicate_name. O(entries of the model, inputs^2,
/// outputs^2).
///
///     const ReducedSystem reduced = compile(d, scene);
///     const System model =
///         compile(diagram_of_model(reduced.state_space(), "reduced"), {.minimize_up_to = 0});
///     write(generate_cpp(model, {.name = "reduced", .sample_time = 0.01}), folder);
Diagram diagram_of_model(const StateSpace& model, const std::string& name);

}  // namespace titop
