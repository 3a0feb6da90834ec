#include "signals.hpp"

namespace titop::python {
namespace {

/// A body for the templates of graph/mount.hpp.
template <int N>
struct ParentPoint {
  DualPort<N> parent;
};

template <class F>
auto on(const TwoWayPort& point, F f) {
  return std::visit(f, point.port);
}

const DualPort<1>* one_axis(const TwoWayPort& point) {
  return std::get_if<DualPort<1>>(&point.port);
}

[[noreturn]] void refuse_sizes() {
  throw Error(Code::size, "points of one and of six degrees of freedom cannot be joined",
              "take one axis of the other point: point.along(r) or point.about(r)");
}

void mount_any(const py::object& body, const TwoWayPort& site, const Rotation& T_ba) {
  const TwoWayPort parent = point_of(body);
  const auto* of_body = one_axis(parent);
  const auto* of_site = one_axis(site);
  if (!of_body != !of_site) refuse_sizes();
  if (of_body)
    mount(ParentPoint<1>{*of_body}, *of_site, here());
  else
    mount(ParentPoint<6>{six_axes(parent)}, six_axes(site), T_ba, here());
}

void weld_any(const TwoWayPort& point, const TwoWayPort& site, const Rotation& T_ba) {
  const auto *of_point = one_axis(point), *of_site = one_axis(site);
  if (!of_point != !of_site) refuse_sizes();
  if (of_point)
    weld(*of_point, *of_site, here());
  else
    weld(six_axes(point), six_axes(site), T_ba, here());
}

void bind_points(py::module_& m) {
  const auto driven = [](auto member, Kind kind) {
    return [member, kind](const TwoWayPort& p) {
      return on(p, [&](const auto& port) { return DrivenPort(p.diagram, member(port), kind); });
    };
  };
  const auto read_only = [](auto member) {
    return [member](const TwoWayPort& p) {
      return on(p, [&](const auto& port) { return ReadSignal(p.diagram, member(port)); });
    };
  };
  const auto accel = driven([](const auto& p) { return detail::SignalRef(p.accel); }, Kind::accel);
  const auto force = driven([](const auto& p) { return detail::SignalRef(p.force); }, Kind::force);
  py::class_<TwoWayPort> type(
      m, "DualPort",
      "A pair of acceleration and wrench at one point, in its body's frame; size 6 (linear; "
      "angular) or 1. Per degree of freedom one is driven, the other one can be read.");
  refuse_comparison(type,
                    "titop: points are not compared. Write mount(a, b.child), or an equation of "
                    "one signal by `=`: a.child.force = signal.");
  type.def_property(
          "accel", accel, [accel](const TwoWayPort& p, const py::object& v) { accel(p).set(v); },
          "Acceleration [m/s^2; rad/s^2].")
      .def_property(
          "force", force, [force](const TwoWayPort& p, const py::object& v) { force(p).set(v); },
          "Wrench [N; N m]: of a child point BY the child ON the body, of a parent point BY the "
          "body ON its parent; an external wrench U on the body is parent.force = -U.")
      .def_property_readonly("reaction", read_only([](const auto& p) { return p.reaction; }),
                             "Force without the terms added by +=: the support force.")
      .def_property_readonly("position", read_only([](const auto& p) { return p.position; }),
                             "Displacement from rest [m; rad], small, in the body's frame.")
      .def_property_readonly("rate", read_only([](const auto& p) { return p.rate; }),
                             "Velocity [m/s; rad/s].")
      .def(
          "along",
          [](const TwoWayPort& p, const Vector3d& r) {
            return TwoWayPort(p.diagram, six_axes(p).along(r));
          },
          "r"_a, "The point's motion and force along the vector r, as a point of one axis.")
      .def(
          "about",
          [](const TwoWayPort& p, const Vector3d& r) {
            return TwoWayPort(p.diagram, six_axes(p).about(r));
          },
          "r"_a, "Angular acceleration and torque about r, as a point of one axis.");
  py::class_<NamedChildren, TwoWayPort>(
      m, "Children", "The child points by name, child[\"C1\"]; also the only one, if there is one.")
      .def("__getitem__", &NamedChildren::at)
      .def("__call__", &NamedChildren::at, "name"_a);
}

}  // namespace

TwoWayPort NamedChildren::at(const std::string& name) const {
  return std::visit([&](const auto& c) { return TwoWayPort(diagram, c(name, here())); }, children);
}

TwoWayPort point_of(const py::handle& body) {
  if (py::isinstance<TwoWayPort>(body)) return body.cast<TwoWayPort>();
  if (!py::hasattr(body, "parent") || !py::isinstance<TwoWayPort>(body.attr("parent")))
    throw py::type_error("titop: a block with a parent point is needed here, or a point");
  return body.attr("parent").cast<TwoWayPort>();
}

DualPort<6> six_axes(const TwoWayPort& point) {
  if (const auto* port = std::get_if<DualPort<6>>(&point.port)) return *port;
  throw Error(Code::size,
              "a point of one axis stands where one of six degrees of freedom is needed",
              "give a point of a body");
}

void bind_mounting(py::module_& m) {
  bind_points(m);
  m.def("mount", &mount_any, "body"_a, "site"_a, "T_ba"_a = Rotation(),
        "Fixes `body` (frame a, at its parent point) to the child point `site` of another body "
        "(frame b). T_ba: components in frame a to components in frame b. For blocks of one axis "
        "the site may be point.along(r) or point.about(r).");
  m.def(
      "weld", &weld_any, "point"_a, "site"_a, "T_ba"_a = Rotation(),
      "Joins two child points, of frames a and b: same motion, opposite wrenches. Closes chains.");
  m.def(
      "ground",
      [](const py::object& body) { on(point_of(body), [](const auto& p) { ground(p, here()); }); },
      "body"_a, "Fixes a body's parent point, or this point, to the inertial frame: accel = 0.");
  m.def(
      "release",
      [](const py::object& body) { on(point_of(body), [](const auto& p) { release(p, here()); }); },
      "body"_a,
      "Leaves the undriven directions of the body's parent point, or of this point, free.");
  m.def(
      "momentum",
      [](const TwoWayPort& port, const Value& h, const Vector3d& axis) {
        momentum(six_axes(port), h, axis, here());
      },
      "port"_a, "h"_a, "axis"_a,
      "Angular momentum h [N m s] of a rotor inside of this point's body, about `axis`.");
}

}  // namespace titop::python
