#include "python.hpp"

namespace titop::python {

Options options_of(int minimize_up_to, const std::string& dump_to, double resolution,
                   const std::string& internal_forces, int exact_up_to) {
  return {minimize_up_to, dump_to, resolution,
          named<InternalForces>(
              internal_forces, "internal_forces",
              {{"refuse", InternalForces::refuse}, {"minimal_norm", InternalForces::minimal_norm}}),
          exact_up_to};
}

namespace {

/// The poles of a model, as a list with a table.
struct PoleList {
  std::vector<Pole> poles;
};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return result;
}

std::string html(const PoleList& list) {
  std::string rows = "<table><tr><th>rad/s</th><th>Hz</th><th>damping</th><th>blocks</th></tr>";
  for (const Pole& p : list.poles) {
    std::string blocks;
    for (const auto& [name, share] : p.blocks)
      blocks += (blocks.empty() ? "" : ", ") + escaped(name) + " " +
                std::to_string(static_cast<int>(100 * share + 0.5)) + " %";
    rows += py::str("<tr><td>{:.7g}</td><td>{:.7g}</td><td>{:.4g}</td><td>{}</td></tr>")
                .format(p.omega, p.hertz, p.damping, blocks)
                .cast<std::string>();
  }
  return rows + "</table>";
}

void bind_poles(py::module_& m) {
  py::class_<Pole>(m, "Pole",
                   "One pole, or a conjugate pair (the one with positive imaginary part).")
      .def_readonly("s", &Pole::s, "[rad/s]")
      .def_readonly("pair", &Pole::pair, "True for s and its conjugate.")
      .def_readonly("omega", &Pole::omega, "|s| [rad/s].")
      .def_readonly("hertz", &Pole::hertz, "|s| / 2 pi [Hz].")
      .def_readonly("damping", &Pole::damping, "-Re(s) / |s|; 0 of s = 0.")
      .def_readonly("blocks", &Pole::blocks, "[(block, share)] of those that take part.")
      .def_property_readonly("unlike_bodies", &Pole::unlike_bodies,
                             "True of an assembled mode that is damped otherwise than its bodies.")
      .def("__repr__", [](const Pole& p) { return to_string(std::vector<Pole>{p}); });
  py::class_<PoleList>(m, "Poles", "Poles by frequency; printed as a table.")
      .def("__len__", [](const PoleList& l) { return l.poles.size(); })
      .def("__getitem__",
           [](const PoleList& l, py::ssize_t i) {
             const auto n = static_cast<py::ssize_t>(l.poles.size());
             if (i < 0) i += n;
             if (i < 0 || i >= n) throw py::index_error();
             return l.poles[static_cast<std::size_t>(i)];
           })
      .def("__getitem__",
           [](const PoleList& l, const py::slice& slice) {
             std::size_t start = 0, stop = 0, step = 0, count = 0;
             if (!slice.compute(l.poles.size(), &start, &stop, &step, &count))
               throw py::error_already_set();
             PoleList part;
             for (std::size_t i = 0; i < count; ++i, start += step)
               part.poles.push_back(l.poles[start]);
             return part;
           })
      .def("__str__", [](const PoleList& l) { return to_string(l.poles); })
      .def("__repr__", [](const PoleList& l) { return to_string(l.poles); })
      .def("_repr_html_", &html);
}

/// The names as given, or x1, x2, ... if none are. Throws size for another number of them.
std::vector<std::string> names_or_numbers(std::vector<std::string> names, Eigen::Index count,
                                          const std::string& letter, const char* what) {
  if (names.empty())
    for (Eigen::Index i = 1; i <= count; ++i) names.push_back(letter + std::to_string(i));
  if (static_cast<Eigen::Index>(names.size()) != count)
    throw Error(Code::size,
                "StateSpace: " + std::to_string(names.size()) + " names for " +
                    std::to_string(count) + " " + what,
                "give one name for each of the " + std::string(what) + ", or none");
  return names;
}

StateSpace model_by_hand(const py::object& A, const py::object& B, const py::object& C,
                         const py::object& D, const std::vector<std::string>& states,
                         const std::vector<std::string>& inputs,
                         const std::vector<std::string>& outputs) {
  StateSpace model{real_array(A, "A of StateSpace"),
                   real_array(B, "B of StateSpace"),
                   real_array(C, "C of StateSpace"),
                   real_array(D, "D of StateSpace"),
                   states,
                   inputs,
                   outputs};
  require_fitting(model, "StateSpace");
  model.states = names_or_numbers(states, model.A.rows(), "x", "states");
  model.inputs = names_or_numbers(inputs, model.B.cols(), "u", "inputs");
  model.outputs = names_or_numbers(outputs, model.C.rows(), "y", "outputs");
  return model;
}

/// A view into a matrix of the model, which stays alive with it.
template <class M>
py::object view(const py::object& model, const M& matrix) {
  return py::cast(matrix, py::return_value_policy::reference_internal, model);
}

void bind_state_space(py::module_& m) {
  py::class_<StateSpace> type(
      m, "StateSpace",
      "xdot = A x + B u, y = C x + D u with names of states, inputs and outputs; without names x1, "
      "u1, y1, ... The matrices are read-only views without a copy; `A, B, C, D = model` takes "
      "them.");
  type.def(py::init(&model_by_hand), "A"_a, "B"_a, "C"_a, "D"_a, py::kw_only(),
           "states"_a = std::vector<std::string>(), "inputs"_a = std::vector<std::string>(),
           "outputs"_a = std::vector<std::string>())
      .def_readonly("A", &StateSpace::A, "n x n.")
      .def_readonly("B", &StateSpace::B, "n x inputs.")
      .def_readonly("C", &StateSpace::C, "outputs x n.")
      .def_readonly("D", &StateSpace::D, "outputs x inputs.")
      .def_readonly("states", &StateSpace::states, "Names, \"z1.stretch\".")
      .def_readonly("inputs", &StateSpace::inputs, "Names, \"U(3)\".")
      .def_readonly("outputs", &StateSpace::outputs, "Names, \"y(1)\".")
      .def_property_readonly("order", &StateSpace::order, "Number of states.")
      .def("transfer", &StateSpace::transfer, "s"_a, Unlocked(),
           "C (s - A)^-1 B + D at s [rad/s], outputs x inputs, complex.")
      .def(
          "poles", [](const StateSpace& s) { return PoleList{poles(s)}; }, "Its poles.")
      .def("__len__", [](const StateSpace&) { return 4; })
      .def("__iter__",
           [](const py::object& self) {
             const auto& s = self.cast<const StateSpace&>();
             return py::iter(py::make_tuple(view(self, s.A), view(self, s.B), view(self, s.C),
                                            view(self, s.D)));
           })
      .def("__str__", [](const StateSpace& s) { return to_string(s); });
  m.def(
      "invert",
      [](const StateSpace& model, const std::vector<std::pair<int, int>>& pairs) {
        return invert(model, pairs);
      },
      "model"_a, "pairs"_a,
      "The model with inputs and outputs exchanged, pairs (input, output) from 0.");
}

template <class Spec>
void def_model_of(py::module_& m) {
  m.def(
      "model_of", [](const Spec& spec) { return model_of(spec); }, "block"_a,
      "A block alone, by its ports' names.");
  m.def(
      "invert",
      [](const Spec& spec, const std::vector<std::string>& channels) {
        return invert(spec, channels);
      },
      "block"_a, "channels"_a,
      "A block with input and output exchanged in channels: \"parent\", \"C1.angular\", "
      "\"parent(3)\".");
}

void bind_energy(py::module_& m) {
  py::class_<PortHamiltonian>(m, "PortHamiltonian",
                              "A block as xdot = (J - R) Q x + G u, y = N pdot + P u, x = [q; p], "
                              "of energy H = x' Q x / 2.")
      .def_readonly("Q", &PortHamiltonian::Q, "2n x 2n.")
      .def_readonly("J", &PortHamiltonian::J, "2n x 2n, skew.")
      .def_readonly("R", &PortHamiltonian::R, "2n x 2n, dissipation.")
      .def_readonly("G", &PortHamiltonian::G, "2n x inputs.")
      .def_readonly("N", &PortHamiltonian::N, "outputs x n.")
      .def_readonly("P", &PortHamiltonian::P, "outputs x inputs.")
      .def(
          "energy",
          [](const PortHamiltonian& h, const Numbers& x) { return h.energy(vector_of(x)); }, "x"_a,
          "H [J].")
      .def(
          "supplied",
          [](const PortHamiltonian& h, const Numbers& x, const Numbers& u) {
            return h.supplied(vector_of(x), vector_of(u));
          },
          "x"_a, "u"_a, "Power at the ports [W].")
      .def(
          "dissipated",
          [](const PortHamiltonian& h, const Numbers& x) { return h.dissipated(vector_of(x)); },
          "x"_a, "[W]")
      .def("state_space", &PortHamiltonian::state_space,
           "The StateSpace of the coordinates x, without names.");
  m.def(
      "port_hamiltonian", [](const SpringMass& spec) { return port_hamiltonian(spec); }, "block"_a,
      "A SpringMass as a port-Hamiltonian system.");
  m.def(
      "port_hamiltonian", [](const FlexibleBody& body) { return port_hamiltonian(body); },
      "block"_a, "A FlexibleBody as a port-Hamiltonian system.");
}

void bind_minimize(py::module_& m) {
  py::class_<JudgedMode>(m, "JudgedMode", "A mode that was removed, or that is near the limit.")
      .def_readonly("omega", &JudgedMode::omega, "|s| [rad/s].")
      .def_readonly("states", &JudgedMode::states, "2 for a pair of poles.")
      .def_readonly("visibility", &JudgedMode::visibility,
                    "Relative half-bandwidth in which it exceeds the rest of the transfer.")
      .def_readonly("bound", &JudgedMode::bound, "Possible visibility by rounding alone.")
      .def_readonly("why", &JudgedMode::why,
                    "\"no input moves it\", \"no output sees it\", \"its pole is at 0\", ...");
  py::class_<Minimized>(m, "Minimized", "A model without the states that have no effect.")
      .def_readonly("model", &Minimized::model, "The StateSpace.")
      .def_readonly("order", &Minimized::order, "Its OrderVerdict.")
      .def_readonly("notes", &Minimized::notes, "Lines of text; the first is the verdict.");
  m.def(
      "minimize",
      [](const StateSpace& model, double resolution, int exact_order) {
        return minimize(model, {.resolution = resolution, .exact_order = exact_order});
      },
      "model"_a, py::kw_only(), "resolution"_a = 0.0, "exact_order"_a = -1, Unlocked(),
      "The StateSpace without modes of a visibility up to `resolution` (0: rounding level only); "
      "exact_order: the minimal order, if it is known.");
}

void bind_certificates(py::module_& m) {
  py::class_<Certificate>(m, "Certificate", "The checks of a system; every number dimensionless.")
      .def_readonly("residual", &Certificate::residual,
                    "Largest backward error of all equations as written.")
      .def_readonly("dense_against_factors", &Certificate::dense_against_factors,
                    "Dense model against the factors, for random x and u; negative: not "
                    "evaluated.")
      .def_readonly("dense_error", &Certificate::dense_error,
                    "Error of A, B, C, D by rounding of their entries; negative: not evaluated.")
      .def_readonly("weakest_pivot", &Certificate::weakest_pivot,
                    "Smallest pivot over the sum of magnitudes of its terms: 1 without "
                    "cancellation, 1e-16 without a digit.")
      .def_readonly(
          "pivot_growth", &Certificate::pivot_growth,
          "Largest ratio of the size of a row of the elimination to its least size before.")
      .def_readonly("margin", &Certificate::margin, "Of algebraic loops; 1 for none.")
      .def("__str__", [](const Certificate& c) { return to_string(c); });
  py::class_<OrderVerdict>(m, "OrderVerdict", "Reliability of the order of a model.")
      .def_readonly("order", &OrderVerdict::order, "Number of states of the model.")
      .def_readonly("lowest", &OrderVerdict::lowest,
                    "Lower end of the interval of the minimal order, included.")
      .def_readonly("highest", &OrderVerdict::highest,
                    "Upper end of the interval of the minimal order, included.")
      .def_readonly("exact", &OrderVerdict::exact, "Decided by exact arithmetic.")
      .def_readonly("to_fewer", &OrderVerdict::to_fewer,
                    "Least visibility among the kept modes: error of removing the next.")
      .def_readonly("to_more", &OrderVerdict::to_more,
                    "Largest visibility among the removed modes.")
      .def_readonly("removed", &OrderVerdict::removed, "List of JudgedMode.")
      .def_readonly("undecided", &OrderVerdict::undecided,
                    "List of JudgedMode, kept or removed near the limit.")
      .def_property_readonly("decided", &OrderVerdict::decided,
                             "True if lowest and highest are equal.")
      .def("__str__", [](const OrderVerdict& v) { return to_string(v); });
  py::class_<FullCertificate>(m, "FullCertificate",
                              "The certificate on request, each item with its own oracle.")
      .def_readonly("faults", &FullCertificate::faults, "Failed checks in words.")
      .def_property_readonly("holds", &FullCertificate::holds, "True without faults.")
      .def_readonly("order", &FullCertificate::order, "OrderVerdict of the minimal dense model.")
      .def_property_readonly(
          "poles_measured", [](const FullCertificate& c) { return c.poles.measured; },
          "Number of poles whose error is measured.")
      .def_property_readonly(
          "poles_count", [](const FullCertificate& c) { return c.poles.count; },
          "Number of all poles before minimal realization.")
      .def("__str__", [](const FullCertificate& c) { return to_string(c); });
  py::class_<Note>(m, "Note", "A line of the compile log.")
      .def_property_readonly(
          "kind", [](const Note& n) { return std::string(to_string(n.kind)); },
          "\"info\", \"inverted\", \"removed\", \"unchecked\" or \"warning\".")
      .def_readonly("pass_", &Note::pass, "The compiler's pass.")
      .def_readonly("text", &Note::text, "Of the line, without the pass.")
      .def("__repr__", [](const Note& n) {
        return "<titop.Note: " + std::string(to_string(n.kind)) + ", pass " + n.pass + ": " +
               n.text + ">";
      });
}

}  // namespace

py::object pole_list(std::vector<Pole> poles) { return py::cast(PoleList{std::move(poles)}); }

void bind_models(py::module_& m) {
  bind_poles(m);
  bind_state_space(m);
  bind_energy(m);
  bind_certificates(m);
  bind_minimize(m);
  def_model_of<SpringMass>(m);
  def_model_of<RigidBody>(m);
  def_model_of<FlexibleBody>(m);
  def_model_of<Hinge>(m);
  def_model_of<Lti>(m);
}

}  // namespace titop::python
