#include "python.hpp"

namespace titop::python {
namespace {

using Values = std::map<std::string, double>;

ParameterList list_of_values(const Values& values) { return {values.begin(), values.end()}; }

std::vector<ParameterList> lists_of(const std::vector<Values>& points) {
  std::vector<ParameterList> result;
  for (const Values& point : points) result.push_back(list_of_values(point));
  return result;
}

void bind_isolated(py::module_& m) {
  py::class_<ParameterRange>(m, "ParameterRange", "The values that a parameter may take.");
  m.def("percent", &percent, "of_nominal"_a, "So many percent below and above the nominal value.");
  m.def("between", &between, "least"_a, "largest"_a, "From least to largest.");
  m.def("full_turn", &full_turn, "Every value of an angle.");
  py::class_<ParameterMap>(m, "ParameterMap", "From a parameter's value to delta in [-1, 1].")
      .def_readonly("nominal", &ParameterMap::nominal, "Value of the parameter at delta = 0.")
      .def_readonly("from_", &ParameterMap::from, "Value of the parameter at delta = -1.")
      .def_readonly("to", &ParameterMap::to, "Value of the parameter at delta = 1.")
      .def("delta", &ParameterMap::delta, "p"_a, "In [-1, 1] for p in [from_, to].")
      .def("value", &ParameterMap::value, "delta"_a, "The value p of the parameter.");
  py::class_<Delta>(m, "Delta", "A parameter in an Lft.")
      .def_readonly("parameter", &Delta::parameter, "Its name.")
      .def_readonly("first", &Delta::first,
                    "Place of its w among [w; u], and of its z among [z; y], from 0.")
      .def_readonly("size", &Delta::size, "Occurrences.")
      .def_readonly("at_least", &Delta::at_least, "Lower bound of them; 0: not computed.")
      .def_readonly("map", &Delta::map, "ParameterMap between its value and delta.")
      .def_property_readonly("minimal", &Delta::minimal,
                             "True if no realization has fewer occurrences of it.");
  py::class_<Lft>(m, "Lft", "Parameters isolated from the model: w = Delta z; printed as a table.")
      .def_property_readonly(
          "m", [](const Lft& f) { return f.m(); },
          "The StateSpace M, inputs [w; u], outputs [z; y].")
      .def_property_readonly(
          "deltas", [](const Lft& f) { return f.deltas(); },
          "List of Delta, in the order of w and z.")
      .def_property_readonly("occurrences", &Lft::occurrences, "Of all parameters: the size of w.")
      .def(
          "at", [](const Lft& f, const Values& v) { return f.at(list_of_values(v)); }, "values"_a,
          Unlocked(), "The StateSpace with Delta closed at {parameter: value}.")
      .def(
          "transfers",
          [](const Lft& f, std::complex<double> s, const std::vector<Values>& points) {
            std::vector<Eigen::MatrixXcd> result;
            {
              const LockReleased unlocked;
              result = f.transfers(s, lists_of(points));
            }
            return stacked(result);
          },
          "s"_a, "values"_a,
          "The transfers at s for each {parameter: value}: n x outputs x inputs.")
      .def("__str__", [](const Lft& f) { return to_string(f); });
  m.def(
      "lft",
      [](const System& s, const std::vector<std::pair<std::string, ParameterRange>>& ranges) {
        return lft(s, ranges);
      },
      "system"_a, "ranges"_a, Unlocked(),
      "Isolates parameters, [(name, percent(20)), (name, between(a, b))].");
  m.def(
      "lft",
      [](const System& s, const py::dict& ranges) {
        ParameterRanges list;
        for (const auto& [name, range] : ranges)
          list.emplace_back(taken<std::string>(name, "the name of a parameter"),
                            taken<ParameterRange>(range, "percent(20) or between(a, b)"));
        const LockReleased unlocked;
        return lft(s, list);
      },
      "system"_a, "ranges"_a, "The same of {name: range}, in this order.");
}

void bind_reduced(py::module_& m) {
  py::class_<ReducedLft>(m, "ReducedLft", "An Lft whose M has fewer states, and the error of M.")
      .def_property_readonly(
          "lft", [](const ReducedLft& r) { return r.lft(); },
          "The Lft with the reduced M, without lower bounds.")
      .def_property_readonly(
          "bound", [](const ReducedLft& r) { return r.bound(); },
          "The ErrorBound of M, outputs [z; y], inputs [w; u].")
      .def("on_ray", &ReducedLft::on_ray, "omega"_a, "The s of the scene's ray at omega [rad/s].")
      .def(
          "error", [](const ReducedLft& r, double omega) { return r.error(omega); }, "omega"_a,
          Unlocked(),
          "Bound of |H - H_r|, outputs x inputs, at on_ray(omega), for all values together.")
      .def(
          "error",
          [](const ReducedLft& r, double omega, const Values& values) {
            return r.error(omega, list_of_values(values));
          },
          "omega"_a, "values"_a, Unlocked(), "The same at {parameter: value} alone.");
  m.def(
      "reduce", [](const Lft& f, const Scene& scene) { return reduce(f, scene); }, "lft"_a,
      "scene"_a, Unlocked(),
      "Reduces M of an Lft over the band and to the accuracy of the scene; the parameters stay.");
}

void bind_derivatives(py::module_& m) {
  py::class_<PoleSlopes>(m, "PoleSlopes", "A pole and how fast it moves with each parameter.")
      .def_readonly("s", &PoleSlopes::s, "[rad/s]")
      .def_readonly("count", &PoleSlopes::count, "Equal poles.")
      .def_readonly("slopes", &PoleSlopes::slopes, "Per parameter [rad/s per unit].")
      .def_readonly("defective", &PoleSlopes::defective,
                    "True if there are fewer eigenvectors than equal poles: it has no slopes.");
  py::class_<Slopes>(m, "Slopes", "A number and its derivatives by the parameters.")
      .def_readonly("value", &Slopes::value, "The number itself.")
      .def_readonly("slopes", &Slopes::slopes,
                    "One per parameter [unit of value per unit of the parameter].");
  py::class_<PeakSlopes, Slopes>(m, "PeakSlopes", "The largest gain and its derivatives.")
      .def_readonly("omega", &PeakSlopes::omega, "Where the peak is [rad/s].");
  py::class_<Derivatives>(m, "Derivatives", "Exact derivatives of a model by its parameters.")
      .def_property_readonly(
          "parameters", [](const Derivatives& g) { return g.parameters(); },
          "Their names, in the order of slopes.")
      .def(
          "transfer",
          [](const Derivatives& g, std::complex<double> s, const std::string& p) {
            return g.transfer(s, p);
          },
          "s"_a, "p"_a, Unlocked(), "dH/dp at s, outputs x inputs.")
      .def("matrices", &Derivatives::matrices, "p"_a, Unlocked(), "dA, dB, dC, dD by p.")
      .def("poles", &Derivatives::poles, Unlocked(), "Poles with their slopes.")
      .def("h2", &Derivatives::h2, Unlocked(), "H2 norm and its slopes.")
      .def(
          "peak",
          [](const Derivatives& g, const std::array<double, 2>& band_hz) {
            return g.peak({.band_hz = band_hz});
          },
          py::kw_only(), "band_hz"_a = HinfOptions().band_hz, Unlocked(),
          "The largest gain over a band [Hz] and its slopes.");
  m.def("derivatives", &derivatives, "system"_a, "parameters"_a, Unlocked(),
        "Derivatives by these parameters at the system's present values.");
}

}  // namespace

void bind_lft(py::module_& m) {
  bind_isolated(m);
  bind_reduced(m);
  bind_derivatives(m);
}

}  // namespace titop::python
