#include "python.hpp"
#include "signals.hpp"

namespace titop::python {
namespace {

Precision precision_of(const std::string& name) {
  return named<Precision>(name, "precision",
                          {{"standard", Precision::standard},
                           {"refined", Precision::refined},
                           {"twofold", Precision::twofold},
                           {"digits50", Precision::digits50},
                           {"as_needed", Precision::as_needed}});
}

std::vector<Eigen::MatrixXcd> responses(const System& s, const std::vector<double>& omega,
                                        int threads, const std::string& precision) {
  const Precision how = precision_of(precision);
  const LockReleased unlocked;
  return s.frequency_response(omega, threads, how);
}

using SystemType = py::class_<System>;

void def_transfers(SystemType& type) {
  type.def(
          "transfer",
          [](const System& s, std::complex<double> at, const std::string& precision) {
            const Precision how = precision_of(precision);
            const LockReleased unlocked;
            return s.transfer(at, how);
          },
          "s"_a, "precision"_a = "as_needed",
          "Transfer matrix at s [rad/s], outputs x inputs, complex, through the factors: full "
          "accuracy at any mass ratio, O(bodies). precision: standard, refined, twofold (32 "
          "digits), digits50 or as_needed.")
      .def(
          "frequency_response",
          [](const System& s, const std::vector<double>& omega, int threads,
             const std::string& precision) {
            return stacked(responses(s, omega, threads, precision));
          },
          "omega"_a, "threads"_a = 0, "precision"_a = "as_needed",
          "transfer(j omega) for each omega [rad/s]: complex, frequencies x outputs x inputs; on "
          "all cores, the same to the last bit for any number of threads.")
      .def("static_gain", &System::static_gain, Unlocked(), "transfer(0), outputs x inputs, real.")
      .def(
          "apply",
          [](const System& s, const Numbers& x, const Numbers& u) {
            System::Rates r = s.apply(vector_of(x), vector_of(u));
            return std::pair(std::move(r.xdot), std::move(r.y));
          },
          "x"_a, "u"_a, "(xdot, y) of the states x and inputs u, through the factors: O(bodies).");
}

void def_models(SystemType& type) {
  type.def(
          "state_space", [](const System& s) -> const StateSpace& { return s.state_space(); },
          py::return_value_policy::reference_internal, Unlocked(),
          "The dense model A, B, C, D with names, minimal up to minimize_up_to states.")
      .def(
          "write",
          [](const System& s) {
            StateSpace model;
            s.write(model);
            return model;
          },
          Unlocked(), "The dense model before minimal realization.")
      .def(
          "descriptor", [](const System& s) { return s.descriptor(); }, Unlocked(),
          "The model before elimination, sparse: O(bodies) entries.")
      .def(
          "poles",
          [](const System& s) {
            std::vector<Pole> list;
            {
              const LockReleased unlocked;
              list = s.poles();
            }
            return pole_list(std::move(list));
          },
          "Poles of state_space() with frequency, damping and blocks.")
      .def(
          "order_verdict", [](const System& s) { return s.order_verdict(); }, Unlocked(),
          "Reliability of the order of state_space().")
      .def("certificate", py::overload_cast<>(&System::certificate, py::const_), Unlocked(),
           "The checks of the factored system.")
      .def("certificate", py::overload_cast<const StateSpace&>(&System::certificate, py::const_),
           "written"_a, Unlocked(), "The same with the rounding error of this model of write().")
      .def("dense_certificate", &System::dense_certificate, Unlocked(),
           "The same with the checks of the dense model.");
}

void def_notes(SystemType& type) {
  type.def_property_readonly("order", &System::order, "States, before minimal realization.")
      .def_property_readonly(
          "states", [](const System& s) { return s.states(); },
          "Names of the states before minimal realization, \"z1.stretch\".")
      .def_property_readonly(
          "inputs", [](const System& s) { return s.inputs(); },
          "Names of the scalar inputs, \"U(3)\".")
      .def_property_readonly(
          "outputs", [](const System& s) { return s.outputs(); },
          "Names of the scalar outputs, \"y(1)\".")
      .def("input", &System::input, "name"_a,
           "Column of this scalar input, \"ref(3)\", in transfers and in u.")
      .def("output", &System::output, "name"_a, "Row of this scalar output in transfers and in y.")
      .def_property_readonly(
          "parameters",
          [](const System& s) {
            py::dict result;
            for (const auto& [name, value] : s.parameters()) result[py::str(name)] = value;
            return result;
          },
          "{name: value} of the diagram's parameters.")
      .def_property_readonly(
          "notes", [](const System& s) { return s.notes(); }, "List of Note: the lines of log().")
      .def_property_readonly(
          "dense_notes", [](const System& s) { return s.dense_notes(); },
          "Notes on the dense model; those of dense_log().")
      .def_property_readonly(
          "seconds", [](const System& s) { return s.seconds(); }, "[(pass, time [s])].")
      .def("log", &System::log, Unlocked(), "Results of the passes, one per line.")
      .def("dense_log", &System::dense_log, Unlocked(), "Notes on the dense model, one per line.")
      .def(
          "update",
          [](const System& s, const std::map<std::string, double>& values) {
            return warned([&] { return s.update(ParameterList(values.begin(), values.end())); },
                          s.notes());
          },
          "values"_a, "The system at other values of parameters, {name: value}, on the same plan.")
      .def("__str__", &System::log, Unlocked())
      .def("__repr__", [](const System& s) {
        return "<titop.System: " + std::to_string(s.order()) + " states, " +
               std::to_string(s.inputs().size()) + " inputs, " +
               std::to_string(s.outputs().size()) + " outputs>";
      });
}

void bind_descriptor(py::module_& m) {
  py::class_<Descriptor>(m, "Descriptor",
                         "The model before elimination: E vdot = A v + B u, y = C v + D u, v the "
                         "states, then the interface unknowns. The matrices are those of "
                         "scipy.sparse: reading them needs SciPy.")
      .def_readonly("E", &Descriptor::E, "diag(I, 0).")
      .def_readonly("A", &Descriptor::A, "(n + unknowns) x (n + unknowns), sparse.")
      .def_readonly("B", &Descriptor::B, "(n + unknowns) x inputs, sparse.")
      .def_readonly("C", &Descriptor::C, "outputs x (n + unknowns), sparse.")
      .def_readonly("D", &Descriptor::D, "outputs x inputs, sparse.")
      .def_readonly("states", &Descriptor::states, "Number of states.")
      .def_readonly("names", &Descriptor::names, "Of v.")
      .def_readonly("inputs", &Descriptor::inputs, "Names of the scalars of u.")
      .def_readonly("outputs", &Descriptor::outputs, "Names of the scalars of y.");
}

}  // namespace

void bind_system(py::module_& m) {
  bind_descriptor(m);
  SystemType type(m, "System",
                  "A compiled diagram: the elimination plan, the factors and the blocks' data. "
                  "Immutable; may be shared between threads.");
  def_transfers(type);
  def_models(type);
  def_notes(type);
  m.def(
      "compile",
      [](const Diagram& d, int minimize_up_to, const std::string& dump_to, double resolution,
         const std::string& internal_forces, int exact_up_to) {
        const Options options =
            options_of(minimize_up_to, dump_to, resolution, internal_forces, exact_up_to);
        return warned([&] { return compile(d, options); });
      },
      "diagram"_a, py::kw_only(), "minimize_up_to"_a = 100, "dump_to"_a = "", "resolution"_a = 0.0,
      "internal_forces"_a = "refuse", "exact_up_to"_a = 0,
      "Compiles a diagram. Raises Error with all mistakes of the first pass that finds any, and "
      "warns (CompileWarning) of each note of the kind \"warning\".");
  m.def(
      "certify", [](const System& s) { return certify(s); }, "system"_a, Unlocked(),
      "The full certificate: transfers, poles, passivity, reciprocity and order over a grid.");
  m.def(
      "exact_order", [](const Diagram& d) { return to_string(exact_order(d.graph())); },
      "diagram"_a, Unlocked(), "The minimal order in arithmetic without rounding, as text.");
  m.def(
      "frequency_response",
      [](const Diagram& d, const std::vector<double>& omega, int threads) {
        std::vector<Eigen::MatrixXcd> result;
        {
          const LockReleased unlocked;
          result = frequency_response(d, omega, threads);
        }
        return stacked(result);
      },
      "diagram"_a, "omega"_a, "threads"_a = 0,
      "Transfers at s = j omega [rad/s] of a diagram with loss factors: frequencies x outputs x "
      "inputs.");
  m.def(
      "damping_of_assembly",
      [](const Diagram& part, const std::string& root,
         const std::map<std::string, std::string>& ports, const py::object& xi,
         const std::string& boundary) {
        std::vector<AssemblyPort> list;
        for (const auto& [name, port] : ports) list.push_back({name, port});
        const auto where =
            named<RootBoundary>(boundary, "boundary",
                                {{"clamped", RootBoundary::clamped}, {"free", RootBoundary::free}});
        if (Value ratio; read(xi, ratio) && !ratio.is_parameter())
          return damping_of_assembly(part, root, list, ratio.nominal(), where, here());
        std::vector<DampingPoint> table;
        for (const auto& [hertz, ratio] : taken<std::vector<std::pair<double, double>>>(
                 xi, "a damping ratio, or a table [(Hz, ratio)],"))
          table.emplace_back(hertz, ratio);
        return damping_of_assembly(part, root, list, ModalDamping(std::move(table)), where, here());
      },
      "part"_a, "root"_a, "ports"_a, "xi"_a, "boundary"_a = "clamped",
      "A body made of a part of the scene in which each assembled mode has the damping ratio xi, a "
      "number or a table [(Hz, ratio)]; ports {child: \"node.port\"}.");
}

}  // namespace titop::python
