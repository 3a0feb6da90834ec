#include "signals.hpp"

namespace titop::python {
namespace {

constexpr const char* kOnlyZero =
    "titop: only the literal 0 may stand alone on the right of an equation. Declare another "
    "constant as an input, c = d.input(\"c\").";
constexpr const char* kNoConstant =
    "titop: a number or parameter cannot be added to a signal. Declare the constant as an input, "
    "c = d.input(\"c\"), and add c.";

[[noreturn]] void no_part(const ReadSignal& signal, const char* part) {
  throw Error(Code::size,
              "a signal of size " + std::to_string(signal.size()) + " has no part " + part,
              ".linear, .angular and .about(r) belong to whole dual vectors of 6");
}

bool is_zero(const py::handle& value) {
  int overflow = 0;
  return PyLong_CheckExact(value.ptr()) && PyLong_AsLongAndOverflow(value.ptr(), &overflow) == 0 &&
         overflow == 0;
}

LinearSum sum(const AnySignal& left, const AnySignal& right, double sign) {
  return {left.diagram, left.expr().plus(right.expr(), sign)};
}

/// signal + 0 is the signal, as in Python's sum(list).
LinearSum plus_constant(const AnySignal& signal, const py::object& value) {
  if (!is_zero(value)) throw py::type_error(kNoConstant);
  return {signal.diagram, signal.expr()};
}

LinearSum times(const AnySignal& signal, const py::object& factor) {
  Value k;
  if (read(factor, k)) return {signal.diagram, k * signal.expr()};
  if (py::isinstance<AnySignal>(factor))
    throw py::type_error(
        "titop: a product of two signals is not linear. Write a number, a parameter, a Rotation "
        "or a matrix times one signal.");
  throw py::type_error(
      "titop: a signal is multiplied by a number or a parameter; write M @ x for "
      "a matrix of NumPy.");
}

LinearSum over(const AnySignal& signal, const py::object& divisor) {
  Value k;
  if (!read(divisor, k)) throw py::type_error("titop: a signal is divided by a number");
  if (k.is_parameter())
    throw py::type_error(
        "titop: a signal cannot be divided by a parameter p. Declare the reciprocal, r = "
        "d.param(\"r\", 1 / number), and write r * x.");
  return {signal.diagram, signal.expr() / k.nominal()};
}

LinearSum matrix_times(const AnySignal& signal, const py::object& object) {
  const py::array M = py::array::ensure(object);
  if (!M || M.ndim() != 2) throw py::type_error("titop: M @ x takes a matrix of two dimensions");
  if (const char kind = M.dtype().kind(); kind != 'f' && kind != 'i' && kind != 'u')
    throw py::type_error("titop: M @ x takes a matrix of real numbers, not of " +
                         py::str(M.dtype()).cast<std::string>());
  return {signal.diagram, M.cast<Eigen::MatrixXd>() * signal.expr()};
}

/// The terms as the user might write them.
std::string text_of(const AnySignal& signal) {
  const Expr sum = signal.expr();
  std::string text;
  for (const Term& term : sum.terms())
    text += (text.empty() ? "" : " + ") + (term.signal < 0 ? "?" : print(*sum.graph(), term));
  return text;
}

void bind_any(py::module_& m) {
  py::class_<AnySignal> type(m, "Signal",
                             "The right-hand side of an equation: ports, readings, inputs "
                             "and sums of them. +, - and products with a number, a parameter, a "
                             "Rotation (T * x) or a matrix (M @ x) make new ones; nothing is "
                             "checked before compile.");
  py::class_<LinearSum, AnySignal>(m, "Expression", "A sum of signals.");
  type.attr("__array_ufunc__") = py::none();  // M @ x and NumPy's numbers * x come to us
  type.def("__add__", [](const AnySignal& l, const AnySignal& r) { return sum(l, r, 1); })
      .def("__add__", &plus_constant)
      .def("__radd__", &plus_constant)
      .def("__sub__", [](const AnySignal& l, const AnySignal& r) { return sum(l, r, -1); })
      .def("__sub__", &plus_constant)
      .def("__rsub__",
           [](const AnySignal&, const py::object&) -> LinearSum {
             throw py::type_error(kNoConstant);
           })
      .def("__neg__", [](const AnySignal& s) { return LinearSum(s.diagram, s.expr().negated()); })
      .def("__mul__", &times)
      .def("__rmul__", &times)
      .def("__truediv__", &over)
      .def("__rmatmul__", &matrix_times)
      .def("__repr__", &text_of);
  refuse_comparison(type,
                    "titop: signals are not compared. An equation is an assignment: write `=`, "
                    "block.port = signal.");
}

void bind_ports(py::module_& m) {
  py::class_<ReadSignal, AnySignal>(m, "Reading",
                                    "A signal of a block, an input, or a part of one; only read.")
      .def_property_readonly("size", &ReadSignal::size, "Number of scalars.")
      .def_property_readonly(
          "linear", [](const ReadSignal& s) { return ReadSignal(s.diagram, s.linear()); },
          "The three translations or forces of a dual vector of 6.")
      .def_property_readonly(
          "angular", [](const ReadSignal& s) { return ReadSignal(s.diagram, s.angular()); },
          "The three rotations or torques of a dual vector of 6.")
      .def(
          "along",
          [](const ReadSignal& s, const Vector3d& r) { return ReadSignal(s.diagram, s.along(r)); },
          "r"_a, "The component along the vector r (any length but 0), of 3 or of the linear half.")
      .def(
          "about",
          [](const ReadSignal& s, const Vector3d& r) { return ReadSignal(s.diagram, s.about(r)); },
          "r"_a, "The angular component about the vector r.");
  py::class_<DrivenPort, ReadSignal> port(m, "Port",
                                          "A port that equations drive: block.port = value once; "
                                          "forces also by +=, before or after =.");
  py::class_<Components>(m, "Components",
                         "Components of a port along vectors: port.along[0, 0, 1] = value writes "
                         "an equation, port.along([0, 0, 1]) reads.")
      .def("__call__", &Components::at, "r"_a)
      .def("__getitem__", &Components::at)
      .def("__setitem__", [](const Components& self, const Vector3d& r, const py::object& value) {
        self.at(r).set(value);
      });
  port.def("__iadd__", [](const DrivenPort& p, const py::object& v) { return p.add(v, 1); })
      .def("__isub__", [](const DrivenPort& p, const py::object& v) { return p.add(v, -1); })
      .def_property(
          "linear", [](const DrivenPort& p) { return p.part(p.linear()); },
          [](const DrivenPort& p, const py::object& v) { p.part(p.linear()).set(v); },
          "The three translations or forces of a dual vector of 6.")
      .def_property(
          "angular", [](const DrivenPort& p) { return p.part(p.angular()); },
          [](const DrivenPort& p, const py::object& v) { p.part(p.angular()).set(v); },
          "The three rotations or torques of a dual vector of 6.")
      .def_property_readonly(
          "along", [](const DrivenPort& p) { return Components{p}; }, "Components along vectors.")
      .def_property_readonly(
          "about",
          [](const DrivenPort& p) {
            return Components{p, true};
          },
          "Angular components about vectors.");
}

}  // namespace

int ReadSignal::size() const {
  if (!ref.part().whole()) return static_cast<int>(ref.part().rows().rows());
  if (ref.signal() < 0) return 6;
  return ref.graph()->signals[static_cast<std::size_t>(ref.signal())].size;
}

detail::SignalRef ReadSignal::linear() const {
  if (size() != 6) no_part(*this, ".linear");
  return ref.linear();
}

detail::SignalRef ReadSignal::angular() const {
  if (size() != 6) no_part(*this, ".angular");
  return ref.angular();
}

detail::SignalRef ReadSignal::along(const Vector3d& r) const {
  return size() == 6 ? ref.linear().along(r) : ref.along(r);
}

detail::SignalRef ReadSignal::about(const Vector3d& r) const {
  if (size() != 6) no_part(*this, ".about(r)");
  return ref.angular().along(r);
}

void DrivenPort::set(const py::handle& value) const {
  if (py::isinstance<DrivenPort>(value)) {
    const auto& other = value.cast<const DrivenPort&>();
    if (other.added && other.ref.graph() == ref.graph() && other.ref.signal() == ref.signal() &&
        other.ref.part().name() == ref.part().name())
      return;
  }
  const Port<0, Kind::force> port(ref);
  port = right_side(value);
}

DrivenPort DrivenPort::add(const py::handle& value, double sign) const {
  if (kind != Kind::force)
    throw py::type_error(
        "titop: += belongs to forces and torques, of which several may act; "
        "write = for an acceleration or a one-way port.");
  const Port<0, Kind::force> port(ref);
  if (sign > 0)
    port += right_side(value);
  else
    port -= right_side(value);
  DrivenPort result = *this;
  result.added = true;
  return result;
}

Rhs right_side(const py::handle& value) {
  if (py::isinstance<AnySignal>(value)) return {value.cast<const AnySignal&>().expr(), here()};
  if (is_zero(value)) {
    Zero zero(0);
    zero.where = here();
    return zero;
  }
  if (py::isinstance<TwoWayPort>(value))
    throw py::type_error(
        "titop: a two-way port is a pair of signals: write mount(a, b.child), or "
        "take .accel or .force of it.");
  throw py::type_error(kOnlyZero);
}

void bind_signals(py::module_& m) {
  bind_any(m);
  bind_ports(m);
}

}  // namespace titop::python
