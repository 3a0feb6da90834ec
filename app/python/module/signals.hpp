#pragma once

#include <variant>

#include "python.hpp"

/// Signals and ports as Python objects. Each keeps the diagram that it points into.
namespace titop::python {

using DiagramPtr = std::shared_ptr<Diagram>;

/// Whatever may stand on the right of an equation.
struct AnySignal {
  explicit AnySignal(DiagramPtr of) : diagram(std::move(of)) {}
  virtual ~AnySignal() = default;
  virtual Expr expr() const = 0;

  DiagramPtr diagram;
};

/// A sum of terms.
struct LinearSum : AnySignal {
  LinearSum(DiagramPtr of, Expr sum) : AnySignal(std::move(of)), value(std::move(sum)) {}
  Expr expr() const override { return value; }

  Expr value;
};

/// A signal of a block, or a part of one, that is only read.
struct ReadSignal : AnySignal {
  ReadSignal(DiagramPtr of, detail::SignalRef signal)
      : AnySignal(std::move(of)), ref(std::move(signal)) {}
  Expr expr() const override { return ref.expr(); }
  int size() const;
  detail::SignalRef linear() const;
  detail::SignalRef angular() const;
  detail::SignalRef along(const Vector3d& r) const;
  detail::SignalRef about(const Vector3d& r) const;

  detail::SignalRef ref;
};

/// A port that equations can drive.
struct DrivenPort : ReadSignal {
  DrivenPort(DiagramPtr of, detail::SignalRef signal, Kind side)
      : ReadSignal(std::move(of), std::move(signal)), kind(side) {}
  /// port = value. A port that comes back from `port += value` is that statement's end: nothing.
  void set(const py::handle& value) const;
  /// port += sign * value; a TypeError of a port that is no force.
  DrivenPort add(const py::handle& value, double sign) const;
  DrivenPort part(detail::SignalRef of_it) const { return {diagram, std::move(of_it), kind}; }

  Kind kind;
  bool added = false;  ///< the result of `+=`
};

/// The components of a port along vectors: `port.along[r] = value`, `port.along(r)`.
struct Components {
  DrivenPort port;
  bool angular = false;
  DrivenPort at(const Vector3d& r) const {
    return port.part(angular ? port.about(r) : port.along(r));
  }
};

/// A pair of acceleration and wrench at one point.
struct TwoWayPort {
  TwoWayPort(DiagramPtr of, std::variant<DualPort<1>, DualPort<6>> pair)
      : diagram(std::move(of)), port(std::move(pair)) {}
  virtual ~TwoWayPort() = default;

  DiagramPtr diagram;
  std::variant<DualPort<1>, DualPort<6>> port;
};

/// The child points of a block by name; also the only one.
struct NamedChildren : TwoWayPort {
  template <int N>
  NamedChildren(DiagramPtr of, const Children<N>& points)
      : TwoWayPort(std::move(of), DualPort<N>(points)), children(points) {}
  TwoWayPort at(const std::string& name) const;

  std::variant<Children<1>, Children<6>> children;
};

/// The ports of a block in a diagram, by its C++ handle.
template <class Handle>
struct PortsOf {
  DiagramPtr diagram;
  Handle ports;
};

/// The right side of an equation, with the script's line. TypeError for anything but a signal and
/// the literal 0.
Rhs right_side(const py::handle& value);

/// The parent point of a body, or the point itself; TypeError for anything else.
TwoWayPort point_of(const py::handle& body);
/// The same with six degrees of freedom; size_error of a port of one axis.
DualPort<6> six_axes(const TwoWayPort& point);

/// Definitions of properties, one line each in the files of the blocks.
template <class Handle>
class Ports {
 public:
  Ports(py::module_& m, const char* name, const char* text) : type_(m, name, text) {}

  template <int N>
  Ports& point(const char* name, DualPort<N> Handle::*port, const char* text) {
    type_.def_property_readonly(
        name,
        [port](const PortsOf<Handle>& self) { return TwoWayPort(self.diagram, self.ports.*port); },
        text);
    return *this;
  }
  template <int N>
  Ports& children(Children<N> Handle::*port, const char* text) {
    type_.def_property_readonly(
        "child",
        [port](const PortsOf<Handle>& self) {
          return NamedChildren(self.diagram, self.ports.*port);
        },
        text);
    return *this;
  }
  template <int N, Kind K>
  Ports& driven(const char* name, Port<N, K> Handle::*port, const char* text) {
    const auto get = [port](const PortsOf<Handle>& self) {
      return DrivenPort(self.diagram, self.ports.*port, K);
    };
    type_.def_property(
        name, get,
        [get](const PortsOf<Handle>& self, const py::object& value) { get(self).set(value); },
        text);
    return *this;
  }
  Ports& read(const char* name, Reading Handle::*port, const char* text) {
    type_.def_property_readonly(
        name,
        [port](const PortsOf<Handle>& self) { return ReadSignal(self.diagram, self.ports.*port); },
        text);
    return *this;
  }
  py::class_<PortsOf<Handle>>& type() { return type_; }

 private:
  py::class_<PortsOf<Handle>> type_;
};

/// Diagram.add for one more spec.
template <class Spec>
void add_to_diagram(py::module_& m) {
  py::class_<Diagram, DiagramPtr>(m.attr("Diagram"))
      .def(
          "add",
          [](const DiagramPtr& d, std::string name, const Spec& spec) {
            return PortsOf<typename Spec::Handle>{d, d->add(std::move(name), spec, here())};
          },
          "name"_a, "block"_a, "Adds a block of this name and returns its ports.");
}

}  // namespace titop::python
