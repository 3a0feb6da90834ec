#include "python.hpp"

namespace titop::python {
namespace {

void bind_excitation(py::module_& m) {
  py::class_<Excitation>(m, "Excitation",
                         "Inputs over time; vectors in the order of System.inputs, matrices inputs "
                         "x samples.")
      .def_static("none", &Excitation::none, "All inputs are 0.")
      .def_static(
          "step", [](const Numbers& u) { return Excitation::step(vector_of(u)); }, "u"_a,
          "u from time 0 on.")
      .def_static(
          "function",
          [](const py::function& u) {
            const std::shared_ptr<py::function> kept(
                new py::function(u), [](py::function* f) { with_lock([&] { delete f; }); });
            return Excitation::function([kept](double t) {
              return with_lock([&] {
                return vector_of(taken<Numbers>((*kept)(t), "u(t), a sequence of numbers,"));
              });
            });
          },
          "u"_a, "u(t) of the time [s], without jumps inside a step.")
      .def_static("held", &Excitation::held, "samples"_a, "period"_a,
                  "Samples (inputs x samples) held for `period` [s] each.")
      .def_static("recorded", &Excitation::recorded, "times"_a, "samples"_a,
                  "A record, linear between its times [s]; jumps are two equal times.")
      .def_static(
          "sampled",
          [](const DiscreteModel& law, const Excitation* more) {
            return Excitation::sampled(law, more ? *more : Excitation::none());
          },
          "law"_a, "more"_a = py::none(),
          "A discrete law in the loop: it samples the outputs that its inputs are called like, and "
          "holds the inputs that its outputs are called like; `more` is added.");
}

Trajectory run(const System& system, const Excitation& excitation, double step, double until,
               const std::string& stepper, const Numbers& x0, bool keep_states, double accuracy) {
  const Simulation simulation{.step = step,
                              .until = until,
                              .stepper = named<Stepper>(stepper, "stepper",
                                                        {{"automatic", Stepper::automatic},
                                                         {"exact", Stepper::exact},
                                                         {"midpoint", Stepper::midpoint},
                                                         {"rk4", Stepper::rk4}}),
                              .x0 = vector_of(x0),
                              .keep_states = keep_states,
                              .accuracy = accuracy};
  const LockReleased unlocked;
  return simulate(system, excitation, simulation);
}

void bind_simulate(py::module_& m) {
  py::class_<Trajectory>(m, "Trajectory", "Result of simulate; a column per time, views of it.")
      .def_property_readonly(
          "time",
          [](const py::object& self) {
            const auto& t = self.cast<const Trajectory&>().time;
            return read_only(
                py::array_t<double>(static_cast<py::ssize_t>(t.size()), t.data(), self));
          },
          "[s]: 0, step, ..., until.")
      .def_readonly("y", &Trajectory::y, "outputs x times.")
      .def_readonly("x", &Trajectory::x, "states x times, or their last column alone.")
      .def_readonly("error", &Trajectory::error, "Estimated relative error per output.")
      .def_property_readonly(
          "stepper", [](const Trajectory& t) { return to_string(t.stepper); },
          "The one used: \"exact\", \"midpoint\" or \"rk4\".")
      .def_readonly("states", &Trajectory::states, "Names of the rows of x.")
      .def_readonly("outputs", &Trajectory::outputs, "Names of the rows of y.");
  m.def("simulate", &run, "system"_a, "excitation"_a, py::kw_only(), "step"_a, "until"_a,
        "stepper"_a = "automatic", "x0"_a = Numbers(), "keep_states"_a = false, "accuracy"_a = 0.01,
        "The response from x0 (states in the order of System.states; none: 0) to the excitation, "
        "in steps of `step` [s] until `until` [s]. stepper: automatic, exact, midpoint or rk4.");
  m.def("rk4_limit", &rk4_limit, "system"_a, Unlocked(), "The largest step [s] that rk4 may take.");
}

using Values = std::map<std::string, double>;

ParameterList list_of(const Values& values) { return {values.begin(), values.end()}; }

/// visit(i, system) at every point, on all cores; its results in a list.
py::list swept(const System& system, const std::vector<Values>& points, const py::function& visit,
               int threads) {
  std::vector<ParameterList> lists;
  for (const Values& point : points) lists.push_back(list_of(point));
  std::vector<py::object> results(points.size(), py::none());
  {
    const LockReleased unlocked;
    sweep(system, lists,
          [&](std::size_t i, const System& at) { with_lock([&] { results[i] = visit(i, at); }); },
          {.threads = threads});
  }
  return py::cast(results);
}

}  // namespace

void bind_simulation(py::module_& m) {
  bind_excitation(m);
  bind_simulate(m);
  m.def(
      "hold",
      [](const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double h) {
        Hold held = hold(A, B, h);
        return std::pair(std::move(held.A), std::move(held.B));
      },
      "A"_a, "B"_a, "h"_a, Unlocked(),
      "(exp(A h), integral of exp(A t) B) at the step h [s]: exact for inputs held over it.");
  m.def("held_response", &held_response, "model"_a, "h"_a, "inputs"_a, Unlocked(),
        "Outputs (outputs x steps) of a StateSpace at t = 0, h, 2 h, ... [s] from x = 0 for inputs "
        "(inputs x steps) held over each step.");
  m.def("sweep", &swept, "system"_a, "points"_a, "visit"_a, "threads"_a = 0,
        "[visit(i, system at points[i])] for a list of {parameter: value}, on all cores: Python's "
        "lock is held in `visit` but not in the System's own computations.");
}

}  // namespace titop::python
