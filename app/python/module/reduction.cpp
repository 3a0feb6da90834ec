#include "python.hpp"

namespace titop::python {
namespace {

std::string bound_name(BoundKind kind) {
  return kind == BoundKind::theorem ? "theorem" : "estimate";
}

void bind_scene(py::module_& m) {
  py::class_<Scene>(m, "Scene",
                    "Requirements on a reduced model: inputs and outputs by name (none: all), "
                    "band_hz (lower, upper) [Hz], accuracy of every pair relative to its own peak, "
                    "on the ray of this damping floor; bound \"estimate\" or \"theorem\".")
      .def(
          py::init([](const std::vector<std::string>& inputs,
                      const std::vector<std::string>& outputs, const std::array<double, 2>& band_hz,
                      double accuracy, double damping_floor, const std::string& bound,
                      int whole_up_to, bool keep_structure, int balance_up_to) {
            return Scene{inputs,
                         outputs,
                         band_hz,
                         accuracy,
                         damping_floor,
                         named<BoundKind>(
                             bound, "bound",
                             {{"estimate", BoundKind::estimate}, {"theorem", BoundKind::theorem}}),
                         whole_up_to,
                         keep_structure,
                         balance_up_to};
          }),
          py::kw_only(), "inputs"_a = std::vector<std::string>(),
          "outputs"_a = std::vector<std::string>(), "band_hz"_a = std::array<double, 2>{0, 0},
          "accuracy"_a = 1e-3, "damping_floor"_a = 0.002, "bound"_a = "estimate",
          "whole_up_to"_a = 2000, "keep_structure"_a = true, "balance_up_to"_a = 800)
      .def_readonly("band_hz", &Scene::band_hz,
                    "(lower, upper) end of the band [Hz]; (0, 0): static gain only.")
      .def_readonly("accuracy", &Scene::accuracy,
                    "Largest error of any pair, relative to its own peak.")
      .def_readonly("damping_floor", &Scene::damping_floor,
                    "Damping ratio of the ray on which errors are measured.");
}

void bind_results(py::module_& m) {
  py::class_<ErrorBound>(m, "ErrorBound", "Error of a reduced system over the scene's band.")
      .def_readonly("pairs", &ErrorBound::pairs, "outputs x inputs, relative.")
      .def_readonly("peak", &ErrorBound::peak, "|error| <= pairs * peak.")
      .def_readonly("worst", &ErrorBound::worst, "The largest of `pairs`.")
      .def_readonly("hertz", &ErrorBound::hertz, "Where it was found [Hz].")
      .def_property_readonly(
          "kind", [](const ErrorBound& b) { return bound_name(b.kind); },
          "\"theorem\" or \"estimate\".");
  py::class_<ReductionStep>(m, "ReductionStep", "One step of the reduction.")
      .def_readonly("name", &ReductionStep::name,
                    "\"structure\", \"bodies\", \"symmetry\", \"whole\"; \"kept\", \"balanced\".")
      .def_readonly("before", &ReductionStep::before,
                    "Second-order coordinates before it; of \"kept\" and \"balanced\": states.")
      .def_readonly("after", &ReductionStep::after, "The same after it.")
      .def_readonly("error", &ReductionStep::error, "Its error, relative as in Scene; 0: exact.")
      .def_readonly("text", &ReductionStep::text, "Description.");
  py::class_<KeptMode>(m, "KeptMode", "A coordinate of the reduced system.")
      .def_readonly("hertz", &KeptMode::hertz, "[Hz]")
      .def_readonly("damping", &KeptMode::damping, "Damping ratio; 0 of motions without stiffness.")
      .def_readonly("blocks", &KeptMode::blocks,
                    "[(block, share of its elastic energy)], largest first, down to 5 %.");
  py::class_<SecondOrderModel>(m, "SecondOrderModel",
                               "M qdd + (D + G) qd + K q = B u, y = C q + C_rate qd + C_accel "
                               "qdd + direct u, M = I, K diagonal, G skew.")
      .def_readonly("M", &SecondOrderModel::M, "r x r, the identity.")
      .def_readonly("D", &SecondOrderModel::D, "r x r [rad/s].")
      .def_readonly("G", &SecondOrderModel::G, "r x r, of rotors' momenta, skew [rad/s].")
      .def_readonly("K", &SecondOrderModel::K, "r x r, diagonal [rad^2/s^2].")
      .def_readonly("B", &SecondOrderModel::B, "r x inputs.")
      .def_readonly("C", &SecondOrderModel::C, "outputs x r, of q.")
      .def_readonly("C_rate", &SecondOrderModel::C_rate, "outputs x r, of qd.")
      .def_readonly("C_accel", &SecondOrderModel::C_accel, "outputs x r, of qdd.")
      .def_readonly("direct", &SecondOrderModel::direct, "outputs x inputs.")
      .def("transfer", &SecondOrderModel::transfer, "s"_a,
           "outputs x inputs at s [rad/s], complex.");
  m.def(
      "port_hamiltonian", [](const SecondOrderModel& model) { return port_hamiltonian(model); },
      "model"_a, "A reduced structure as a port-Hamiltonian system.");
  py::class_<ModalModel>(m, "ModalModel", "A of 2 x 2 blocks, one per mode; B, C, D.")
      .def_readonly("A", &ModalModel::A, "List of 2 x 2 matrices, one per mode [rad/s].")
      .def_readonly("B", &ModalModel::B, "2r x inputs.")
      .def_readonly("C", &ModalModel::C, "outputs x 2r.")
      .def_readonly("D", &ModalModel::D, "outputs x inputs.");
}

void bind_system_of_scene(py::module_& m) {
  py::class_<ReducedSystem>(m, "ReducedSystem",
                            "The reduced system of a scene, and the bound of its error.")
      .def_property_readonly("order", &ReducedSystem::order, "Number of states of state_space().")
      .def_property_readonly(
          "inputs", [](const ReducedSystem& r) { return r.inputs(); },
          "Names of the scene's scalar inputs, in the diagram's order.")
      .def_property_readonly(
          "outputs", [](const ReducedSystem& r) { return r.outputs(); },
          "Names of the scene's scalar outputs, in the diagram's order.")
      .def_property_readonly(
          "full", [](const ReducedSystem& r) { return r.full(); },
          "The full system with the scene's inputs and outputs.")
      .def("transfer", &ReducedSystem::transfer, "s"_a, Unlocked(), "outputs x inputs, complex.")
      .def("state_space", &ReducedSystem::state_space, Unlocked(),
           "The dense StateSpace; states \"mode1\", \"mode1_rate\", ...; of balanced models "
           "\"kept1\", ...")
      .def("second_order", &ReducedSystem::second_order, Unlocked(), "M, D, K kept.")
      .def("modal", &ReducedSystem::modal, Unlocked(), "2 x 2 blocks.")
      .def_property_readonly(
          "bound", [](const ReducedSystem& r) { return r.bound(); }, "Its ErrorBound.")
      .def_property_readonly(
          "steps", [](const ReducedSystem& r) { return r.steps(); },
          "List of ReductionStep, in order.")
      .def_property_readonly(
          "modes", [](const ReducedSystem& r) { return r.modes(); }, "List of KeptMode.")
      .def_property_readonly(
          "notes", [](const ReducedSystem& r) { return r.notes(); },
          "Warnings: bodies whose own data end below 1.5 times the band.")
      .def("__str__", [](const ReducedSystem& r) { return to_string(r); });
  py::class_<WhatIf>(m, "WhatIf", "One line of what_if.")
      .def_readonly("accuracy", &WhatIf::accuracy, "Required.")
      .def_readonly("order", &WhatIf::order, "States.")
      .def_readonly("bound", &WhatIf::bound, "Reached, relative as in Scene.")
      .def_readonly("system", &WhatIf::system, "The ReducedSystem.");
}

}  // namespace

void bind_reduction(py::module_& m) {
  bind_scene(m);
  bind_results(m);
  bind_system_of_scene(m);
  m.def(
      "compile",
      [](const Diagram& d, const Scene& scene, int minimize_up_to, const std::string& dump_to,
         double resolution, const std::string& internal_forces, int exact_up_to) {
        const Options options =
            options_of(minimize_up_to, dump_to, resolution, internal_forces, exact_up_to);
        return warned([&] { return compile(d, scene, options); });
      },
      "diagram"_a, "scene"_a, py::kw_only(), "minimize_up_to"_a = 100, "dump_to"_a = "",
      "resolution"_a = 0.0, "internal_forces"_a = "refuse", "exact_up_to"_a = 0,
      "The reduced model of a scene.");
  m.def(
      "what_if",
      [](const Diagram& d, const Scene& scene, const std::vector<double>& accuracies) {
        return what_if(d, scene, accuracies);
      },
      "diagram"_a, "scene"_a, "accuracies"_a, Unlocked(),
      "The same scene for several accuracies: their orders.");
}

}  // namespace titop::python
