#include "python.hpp"

namespace titop::python {
namespace {

/// The loop, with Python's warnings of the cut diagram.
template <class F>
ControlLoop warned_loop(const System& system, F make) {
  ControlLoop loop = [&] {
    const LockReleased unlocked;
    return make();
  }();
  warn(loop.L.notes(), system.notes());
  return loop;
}

void bind_loops(py::module_& m) {
  py::class_<ControlLoop>(
      m, "ControlLoop",
      "A loop cut at loop points, of negative feedback: L, S = (1 + L)^-1 and T "
      "= 1 - S as systems.")
      .def_readonly("points", &ControlLoop::points,
                    "Names of the loop points, in the order of rows and columns.")
      .def_readonly("L", &ControlLoop::L, "Loop transfer.")
      .def_readonly("S", &ControlLoop::S, "Sensitivity.")
      .def_readonly("T", &ControlLoop::T, "Complementary sensitivity.");
  m.def(
      "loop",
      [](const System& s, const std::string& name) {
        return warned_loop(s, [&] { return loop(s, name); });
      },
      "system"_a, "name"_a, "The loop at this loop point.");
  m.def(
      "mimo_loop",
      [](const System& s, const std::vector<std::string>& names) {
        return warned_loop(s, [&] { return mimo_loop(s, names); });
      },
      "system"_a, "names"_a, "The loop cut at several points at once.");
  m.def("loop_points", &loop_points, "system"_a, "Names of the loop points.");
}

void bind_responses(py::module_& m) {
  py::class_<BodeResponse>(m, "BodeResponse", "One response over frequencies.")
      .def_property_readonly(
          "omega", [](const BodeResponse& r) { return py::array(py::cast(r.omega)); }, "[rad/s]")
      .def_property_readonly(
          "decibels", [](const BodeResponse& r) { return py::array(py::cast(r.decibels)); },
          "Magnitude at each omega [dB].")
      .def_property_readonly(
          "degrees", [](const BodeResponse& r) { return py::array(py::cast(r.degrees)); },
          "Phase at each omega [deg].");
  m.def(
      "bode",
      [](const System& s, const std::string& output, const std::string& input,
         const std::vector<double>& omega) { return bode(s, output, input, omega); },
      "system"_a, "output"_a, "input"_a, "omega"_a, Unlocked(),
      "Magnitude [dB] and phase [deg] of one output to one input over omega [rad/s].");
  m.def("transmission_zeros", &transmission_zeros, "model"_a, Unlocked(),
        "Transmission zeros of a StateSpace [rad/s].");
  m.def("norm_h2", &norm_h2, "model"_a, Unlocked(), "The H2 norm of a StateSpace.");
  py::class_<HinfNorm>(m, "HinfNorm", "The largest gain of a model.")
      .def_readonly("value", &HinfNorm::value,
                    "Largest singular value of the transfer over the band.")
      .def_readonly("omega", &HinfNorm::omega, "[rad/s]; inf: of the direct term.");
  m.def(
      "norm_hinf",
      [](const StateSpace& model, const std::array<double, 2>& band_hz) {
        return norm_hinf(model, {.band_hz = band_hz});
      },
      "model"_a, py::kw_only(), "band_hz"_a = HinfOptions().band_hz, Unlocked(),
      "The H-infinity norm of a StateSpace over a band [Hz].");
  m.def(
      "input_values",
      [](const System& s, const std::map<std::string, double>& values) {
        return input_values(s, ParameterList(values.begin(), values.end()));
      },
      "system"_a, "values"_a, "The input vector with these values {name: value}, 0 elsewhere.");
}

void bind_discrete(py::module_& m) {
  py::class_<DiscreteModel>(m, "DiscreteModel",
                            "x(k + 1) = A x(k) + B u(k), y(k) = C x(k) + D u(k) at a period [s].")
      .def_readonly("model", &DiscreteModel::model,
                    "StateSpace with A, B, C, D of the difference equations.")
      .def_readonly("period", &DiscreteModel::period, "[s]")
      .def("at", &DiscreteModel::at, "omega"_a, "The transfer at exp(j omega period).");
  m.def(
      "discretize",
      [](const StateSpace& model, double period, const std::string& method, double prewarp) {
        return discretize(
            model, period,
            named<Discretization>(method, "method",
                                  {{"zero_order_hold", Discretization::zero_order_hold},
                                   {"first_order_hold", Discretization::first_order_hold},
                                   {"tustin", Discretization::tustin}}),
            prewarp);
      },
      "model"_a, "period"_a, "method"_a = "zero_order_hold", "prewarp"_a = 0.0,
      "The StateSpace at this period [s]: zero_order_hold, first_order_hold or tustin, the last "
      "exact at prewarp [rad/s].");
  m.def("series", &series, "first"_a, "second"_a, "First, then second: y2 of u1.");
  m.def("pade", &pade, "delay"_a, "order"_a, "The Pade approximation of a delay [s] as an Lti.");
}

}  // namespace

void bind_control(py::module_& m) {
  bind_loops(m);
  bind_responses(m);
  bind_discrete(m);
}

}  // namespace titop::python
