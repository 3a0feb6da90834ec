#include "signals.hpp"

namespace titop::python {
namespace {

/// d.output["x"] = signal, d.output["x", 6] = signal.
struct Outputs {
  DiagramPtr diagram;
};

/// Number of scalars of a right side: that of its first term that has one; 1 if none has.
int size_of(const Graph& graph, const Expr& value) {
  for (const Term& term : value.terms())
    if (const int rows = term.signal < 0 ? -1 : rows_of(graph, term); rows > 0) return rows;
  return 1;
}

void set_output(const Outputs& outputs, const std::string& name, int size,
                const py::object& value) {
  Diagram& d = *outputs.diagram;
  const Rhs right = right_side(value);
  const Graph* const graph = right.expr().graph();
  if (size <= 0 && graph) size = size_of(*graph, right.expr());
  d.output(name, size > 0 ? size : 1, here()) = right;
}

void bind_outputs(py::module_& m) {
  py::class_<Outputs>(m, "Outputs",
                      "The outputs of a diagram: d.output[\"x\"] = signal declares one of the "
                      "signal's size, d.output[\"x\", 6] = signal one of 6 scalars.")
      .def("__setitem__", [](const Outputs& o, const std::string& name,
                             const py::object& value) { set_output(o, name, 0, value); })
      .def("__setitem__", [](const Outputs& o, const std::pair<std::string, int>& name_and_size,
                             const py::object& value) {
        if (name_and_size.second < 1)
          o.diagram->output(name_and_size.first, name_and_size.second, here()) = right_side(value);
        else
          set_output(o, name_and_size.first, name_and_size.second, value);
      });
}

Value value_of(const py::object& object, const char* what) {
  Value v;
  if (!read(object, v)) throw py::type_error(what);
  return v;
}

Parameter scaled(const Parameter& p, const py::object& factor, bool divide) {
  const Value v = value_of(factor, "titop: a parameter is multiplied by a number");
  if (v.is_parameter())
    throw py::type_error(
        divide ? "titop: a quotient by a parameter p is not a parameter. Declare the reciprocal, "
                 "r = d.param(\"r\", 1 / number), and multiply by r."
               : "titop: a product of two parameters p, q is not a parameter. For a signal x write "
                 "p * (q * x); for a block declare d.param(\"pq\", number).");
  return {divide ? p.value / v.nominal() : v.nominal() * p.value, p.diagram};
}

void bind_parameters(py::module_& m) {
  const auto refuse = [](const Parameter&, const py::object&) -> py::object {
    throw py::type_error(
        "titop: a sum with a parameter p is not a parameter. For a signal x write p * x + q * x; "
        "for a block declare d.param(\"sum\", number).");
  };
  py::class_<Parameter> type(m, "Parameter",
                             "A parameter of a diagram, or a number times one: for use wherever a "
                             "block or an equation takes a number.");
  type.attr("__array_ufunc__") = py::none();
  const auto times = [](const Parameter& p, const py::object& k) -> py::object {
    if (py::isinstance<AnySignal>(k)) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
    return py::cast(scaled(p, k, false));
  };
  type.def_property_readonly(
          "nominal", [](const Parameter& p) { return p.value.nominal(); }, "Its nominal value.")
      .def("__mul__", times)
      .def("__rmul__", times)
      .def("__truediv__",
           [](const Parameter& p, const py::object& k) { return scaled(p, k, true); })
      .def("__rtruediv__",
           [](const Parameter& p, const py::object&) { return scaled(p, py::cast(p), true); })
      .def("__neg__",
           [](const Parameter& p) {
             return Parameter{-p.value, p.diagram};
           })
      .def("__add__", refuse)
      .def("__radd__", refuse)
      .def("__sub__", refuse)
      .def("__rsub__", refuse);
}

void bind_rotation(py::module_& m) {
  py::class_<Rotation> type(m, "Rotation",
                            "Direction cosine matrix T_ba, [v]_b = T_ba [v]_a; on dual vectors "
                            "diag(T_ba, T_ba). Rotation() is the identity.");
  type.attr("__array_ufunc__") = py::none();
  const auto product = [](const Rotation& T, const Rotation& S) { return T * S; };
  const auto turned = [](const Rotation& T, const AnySignal& s) {
    return LinearSum(s.diagram, T * s.expr());
  };
  type.def(py::init<>())
      .def_static("about", &Rotation::about, "axis"_a, "angle"_a,
                  "By angle [rad], a number or a parameter, about the vector axis (any length but "
                  "0): the columns are the axes of the rotated frame a in frame b.")
      .def_static(
          "matrix",
          [](const py::object& T) {
            return Rotation::matrix(real_array<Matrix3d>(T, "T of Rotation.matrix (3 x 3)"));
          },
          "T"_a, "From its 3 x 3 matrix; not-a-rotation unless orthonormal to 1e-9 and det > 0.")
      .def("named", &Rotation::named, "to"_a, "from_"_a,
           "The same with names of frames: components in from_ to components in to.")
      .def_property_readonly("inverse", &Rotation::inverse, "T_ab from T_ba.")
      .def_property_readonly("nominal", &Rotation::nominal, "3 x 3, parameters at nominal values.")
      .def("__mul__", product)
      .def("__matmul__", product)
      .def("__mul__", turned)
      .def("__matmul__", turned);
}

}  // namespace

void bind_diagram(py::module_& m) {
  bind_parameters(m);
  bind_rotation(m);
  bind_outputs(m);
  py::class_<Diagram, DiagramPtr>(
      m, "Diagram",
      "Blocks, equations on their ports, inputs, outputs and parameters. Mistakes in names and "
      "equations are collected and raised together by compile.")
      .def(py::init<std::string>(), "name"_a)
      .def_property_readonly("name", &Diagram::name, "As given.")
      .def(
          "clone", [](const Diagram& d) { return std::make_shared<Diagram>(d.clone()); },
          "An independent copy; ports of the original keep pointing into the original.")
      .def(
          "input",
          [](const DiagramPtr& d, std::string name, int size) {
            return ReadSignal(d, d->input(std::move(name), size, here()));
          },
          "name"_a, "size"_a = 1, "An external input of `size` scalars.")
      .def_property_readonly(
          "output", [](const DiagramPtr& d) { return Outputs{d}; },
          "d.output[\"x\"] = signal declares an output.")
      .def(
          "param",
          [](const DiagramPtr& d, std::string name, double value) {
            return Parameter{Value(d->param(std::move(name), value, here())), d};
          },
          "name"_a, "value"_a,
          "A parameter with its nominal value, for use wherever a number may stand.")
      .def(
          "loop_point",
          [](const DiagramPtr& d, std::string name, const py::object& signal) {
            return ReadSignal(d, d->loop_point(std::move(name), right_side(signal)));
          },
          "name"_a, "signal"_a,
          "Returns the signal for use in its place: a point at which loop(system, name) cuts.");
}

}  // namespace titop::python
