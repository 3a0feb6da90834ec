#include "signals.hpp"

namespace titop::python {
namespace {

void bind_mode_shapes(py::module_& m) {
  py::class_<StructurePoint>(m, "StructurePoint", "A port of a body or joint.")
      .def_readonly("name", &StructurePoint::name, "\"wing.C1\"")
      .def_readonly("place", &StructurePoint::place,
                    "From the first point of its assembly, in the frame of that [m].");
  py::class_<ModeShape>(m, "ModeShape",
                        "Motion of all points in one mode: the real part of motion exp(s t), in "
                        "the frame of the first point of each assembly; a column per point.")
      .def_readonly("index", &ModeShape::index, "Of its pole in system.poles().")
      .def_readonly("pole", &ModeShape::pole, "The Pole itself.")
      .def_readonly("translation", &ModeShape::translation,
                    "3 x points, complex [m]; the largest is 1 m.")
      .def_readonly("rotation", &ModeShape::rotation, "3 x points, complex [rad].");
  py::class_<ModeShapes>(m, "ModeShapes", "The points of a structure, and their motion in modes.")
      .def_readonly("points", &ModeShapes::points,
                    "List of StructurePoint: the columns of the motions.")
      .def_readonly("lines", &ModeShapes::lines,
                    "Pairs of points: from a body's parent point to each of its children.")
      .def_readonly("modes", &ModeShapes::modes, "Of the requested poles that have a shape.")
      .def_readonly("without", &ModeShapes::without, "The others, with the reason.")
      .def_readonly("notes", &ModeShapes::notes,
                    "Blocks without positions and unknown distances, in words.");
  m.def(
      "mode_shapes",
      [](const System& s, const std::vector<int>& poles) { return mode_shapes(s, poles); },
      "system"_a, "poles"_a, Unlocked(),
      "Shapes of modes, given by the indices of their poles in system.poles(): the motion that the "
      "inputs excite.");
}

void bind_bracket(py::module_& m) {
  using Interval = InterfaceBracket::Interval;
  py::class_<Interval>(m, "Interval", "An interval of a frequency or a compliance.")
      .def_readonly("below", &Interval::below, "Lower end [unit of the quantity].")
      .def_readonly("above", &Interval::above, "Upper end [unit of the quantity].")
      .def_property_readonly("width", &Interval::width, "above - below.");
  py::class_<InterfaceBracket>(m, "InterfaceBracket",
                               "Bounds over the lumping of interfaces; printed as a table.")
      .def_readonly("omega", &InterfaceBracket::omega, "Intervals, ascending [rad/s].")
      .def_readonly("compliance", &InterfaceBracket::compliance, "[m/N, rad/(N m)]")
      .def_readonly("transfer_difference", &InterfaceBracket::transfer_difference,
                    "Largest difference of an entry of both transfers, relative to its largest "
                    "value: an estimate.")
      .def("__str__", [](const InterfaceBracket& b) { return to_string(b); });
  m.def(
      "interface_bracket",
      [](const py::function& scene, int modes, const std::vector<std::pair<int, int>>& compliances,
         const std::vector<double>& omega) {
        const auto made = [&](Lumping lumping) {
          return with_lock([&] {
            const char* const name = lumping == Lumping::constrained ? "constrained" : "released";
            return taken<DiagramPtr>(scene(name), "a Diagram of scene(lumping)")->clone();
          });
        };
        const LockReleased unlocked;
        return interface_bracket(made, {modes, compliances, omega});
      },
      "scene"_a, py::kw_only(), "modes"_a = 6, "compliances"_a = std::vector<std::pair<int, int>>(),
      "omega"_a = std::vector<double>(),
      "Natural frequencies of the scene with every node joined lie between those of two models: "
      "scene(\"constrained\"), with fe.rigid and fe.shapes, and scene(\"released\"), with "
      "fe.average and fe.moments. compliances: pairs (input, output) from 0; omega [rad/s]: where "
      "the transfers are compared.");
}

}  // namespace

void bind_shapes(py::module_& m) {
  bind_mode_shapes(m);
  bind_bracket(m);
}

}  // namespace titop::python
