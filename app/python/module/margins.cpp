#include "python.hpp"

namespace titop::python {
namespace {

void bind_parts(py::module_& m) {
  py::class_<MarginAt>(m, "MarginAt", "A margin and its frequency [rad/s].")
      .def_readonly("value", &MarginAt::value, "The margin, in the unit of its kind.")
      .def_readonly("omega", &MarginAt::omega, "[rad/s]")
      .def("__repr__", [](const MarginAt& a) {
        return py::str("MarginAt(value={}, omega={})").format(a.value, a.omega);
      });
  py::class_<LoopCrossing>(m, "LoopCrossing", "A point of L(j omega) on the unit circle or axis.")
      .def_readonly("omega", &LoopCrossing::omega, "[rad/s]")
      .def_readonly("L", &LoopCrossing::L, "Its value there, complex.");
  py::class_<DiskMargin>(m, "DiskMargin", "alpha = 2 / ||S - T||_inf, 0 to 2.")
      .def_readonly("alpha", &DiskMargin::alpha, "2 / ||S - T||_inf, 0 to 2.")
      .def_readonly("omega", &DiskMargin::omega, "[rad/s]")
      .def_property_readonly("least_gain", &DiskMargin::least_gain,
                             "(2 - alpha) / (2 + alpha): least factor of the loops' gains.")
      .def_property_readonly("largest_gain", &DiskMargin::largest_gain,
                             "(2 + alpha) / (2 - alpha), infinite for alpha = 2.")
      .def_property_readonly("phase", &DiskMargin::phase, "[rad]");
  py::class_<NyquistCount>(m, "NyquistCount", "Stability by closed-loop poles and by turns.")
      .def_readonly("open_right", &NyquistCount::open_right, "P, poles of L right of the axis.")
      .def_readonly("closed_right", &NyquistCount::closed_right,
                    "Z, closed-loop poles right of the axis.")
      .def_readonly("closed_on_axis", &NyquistCount::closed_on_axis,
                    "Closed-loop poles on the axis, up to rounding.")
      .def_readonly("encirclements", &NyquistCount::encirclements,
                    "N, clockwise turns of det(1 + L(s)) about 0.")
      .def_readonly("agree", &NyquistCount::agree, "N = Z - P; with a delay: N is whole.");
}

}  // namespace

void bind_margins(py::module_& m) {
  bind_parts(m);
  py::class_<LoopMargins>(m, "LoopMargins",
                          "Margins of one loop, all others closed; infinite: nothing of this kind "
                          "makes it unstable.")
      .def_readonly("point", &LoopMargins::point, "Name of the loop, \"attitude(2)\".")
      .def_readonly("larger_gain", &LoopMargins::larger_gain, "Least factor above 1 to -1.")
      .def_readonly("smaller_gain", &LoopMargins::smaller_gain, "Largest factor below 1 to -1.")
      .def_readonly("phase", &LoopMargins::phase, "[rad]")
      .def_readonly("delay", &LoopMargins::delay, "[s]")
      .def_readonly("nearest", &LoopMargins::nearest, "Least distance of L to -1.")
      .def_readonly("disk", &LoopMargins::disk, "DiskMargin of this loop.")
      .def_readonly("unit", &LoopMargins::unit, "All LoopCrossing of |L| = 1, by frequency.")
      .def_readonly("negative", &LoopMargins::negative,
                    "All LoopCrossing of the negative real axis, by frequency.");
  py::class_<Margins>(m, "Margins", "Margins of a loop; printed as a table.")
      .def_readonly("stable", &Margins::stable,
                    "True if all closed-loop poles are left of the axis and the counts agree.")
      .def_readonly("nyquist", &Margins::nyquist, "The NyquistCount of det(1 + L).")
      .def_readonly("disk", &Margins::disk, "Of all loops at once.")
      .def_readonly("nearest", &Margins::nearest, "Of all loops at once.")
      .def_readonly("loops", &Margins::loops, "Of each loop alone.")
      .def_readonly("warnings", &Margins::warnings, "Of the log of a ControlLoop's L.")
      .def("__str__", [](const Margins& a) { return to_string(a); });
  m.def(
      "margins",
      [](const ControlLoop& l, double delay) { return margins(l, MarginOptions{delay}); }, "loop"_a,
      py::kw_only(), "delay"_a = 0.0, Unlocked(),
      "Gain, phase, delay and disk margins of a ControlLoop, with a delay [s] in it.");
  m.def(
      "margins", [](const StateSpace& L, double delay) { return margins(L, MarginOptions{delay}); },
      "loop"_a, py::kw_only(), "delay"_a = 0.0, Unlocked(),
      "The same of a loop transfer L (n x n).");
  m.def(
      "margins", [](const DiscreteModel& L) { return margins(L); }, "loop"_a, Unlocked(),
      "The same of a discrete loop transfer.");
}

}  // namespace titop::python
