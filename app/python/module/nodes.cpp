#include "signals.hpp"

namespace titop::python {
namespace {

/// The inputs of a Sum: sum.in_[1] = signal.
struct SumInputs {
  DiagramPtr diagram;
  Sum::Handle ports;
  DrivenPort at(int i) const { return {diagram, ports.in(i), Kind::plain}; }
};

void bind_lti(py::module_& m) {
  using Entry = std::tuple<char, int, int, Value>;
  py::class_<Lti>(m, "Lti",
                  "A controller or filter: xdot = A x + B u, y = C x + D u, plain signals without "
                  "frames. A n x n, B n x nu, C ny x n, D ny x nu; an empty D is 0; A, B and C "
                  "empty for a pure D. values: [(\"A\", 2, 1, -1 * k)] puts a parameter in place "
                  "of an entry, counted from 1.")
      .def(py::init([](const py::object& A, const py::object& B, const py::object& C,
                       const py::object& D, const std::vector<Entry>& values) {
             Lti spec{.A = real_array(A, "A of Lti"),
                      .B = real_array(B, "B of Lti"),
                      .C = real_array(C, "C of Lti"),
                      .D = real_array(D, "D of Lti")};
             for (const auto& [matrix, row, column, value] : values)
               spec.values.push_back({matrix, row, column, value});
             return spec;
           }),
           py::kw_only(), "A"_a = Eigen::MatrixXd(), "B"_a = Eigen::MatrixXd(),
           "C"_a = Eigen::MatrixXd(), "D"_a = Eigen::MatrixXd(), "values"_a = std::vector<Entry>())
      .def_readonly("A", &Lti::A, "n x n.")
      .def_readonly("B", &Lti::B, "n x inputs.")
      .def_readonly("C", &Lti::C, "outputs x n.")
      .def_readonly("D", &Lti::D, "outputs x inputs; empty: 0.");
  Ports<Lti::Handle>(m, "LtiPorts", "Ports of an Lti or Integrator in a diagram.")
      .driven("in_", &Lti::Handle::in, "Its input.")
      .read("out", &Lti::Handle::out, "Its output.");
  py::class_<Integrator>(m, "Integrator", "out = integral of in_, `size` scalars, 0 at the start.")
      .def(py::init([](int size) { return Integrator{size}; }), py::kw_only(), "size"_a = 1);
}

void bind_gains(py::module_& m) {
  py::class_<Gain>(m, "Gain", "out = gain * in_, `size` scalars [unit of out / unit of in_].")
      .def(py::init([](const Value& gain, int size) {
             return Gain{gain, size};
           }),
           py::kw_only(), "gain"_a = 1.0, "size"_a = 1);
  py::class_<MatrixGain>(m, "MatrixGain", "out = matrix @ in_, matrix rows x columns.")
      .def(py::init([](const Eigen::MatrixXd& matrix) { return MatrixGain{matrix}; }),
           py::kw_only(), "matrix"_a);
  Ports<Gain::Handle>(m, "GainPorts", "Ports of a Gain or MatrixGain in a diagram.")
      .driven("in_", &Gain::Handle::in, "Its input.")
      .read("out", &Gain::Handle::out, "Its output.");
}

void bind_sum(py::module_& m) {
  py::class_<Sum>(m, "Sum", "out = +-in_[1] +-in_[2] ..., one sign per input: Sum(signs=\"+-\").")
      .def(py::init([](const std::string& signs, int size) {
             return Sum{signs, size};
           }),
           py::kw_only(), "signs"_a = "++", "size"_a = 1);
  py::class_<SumInputs>(m, "SumInputs", "The inputs of a Sum, counted from 1: s.in_[1] = signal.")
      .def("__getitem__", &SumInputs::at)
      .def("__setitem__",
           [](const SumInputs& s, int i, const py::object& value) { s.at(i).set(value); });
  Ports<Sum::Handle>(m, "SumPorts", "Ports of a Sum in a diagram.")
      .read("out", &Sum::Handle::out, "Its output.")
      .type()
      .def_property_readonly(
          "in_",
          [](const PortsOf<Sum::Handle>& s) {
            return SumInputs{s.diagram, s.ports};
          },
          "Its inputs, counted from 1.");
}

}  // namespace

void bind_nodes(py::module_& m) {
  bind_gains(m);
  bind_sum(m);
  bind_lti(m);
  add_to_diagram<Gain>(m);
  add_to_diagram<MatrixGain>(m);
  add_to_diagram<Sum>(m);
  add_to_diagram<Lti>(m);
  add_to_diagram<Integrator>(m);
}

}  // namespace titop::python
