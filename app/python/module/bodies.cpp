#include "signals.hpp"

namespace titop::python {
namespace {

using ModeEntry = std::tuple<int, int, Value>;
using ShapeEntries = std::map<std::string, std::vector<ModeEntry>>;

std::vector<ModeValues::Entry> entries(const std::vector<ModeEntry>& list) {
  std::vector<ModeValues::Entry> result;
  for (const auto& [mode, component, value] : list) result.push_back({mode, component, value});
  return result;
}

/// Child points from {"C1": [x, y, z]}; None is at P.
std::vector<ChildPoint> child_points(const py::dict& points) {
  std::vector<ChildPoint> result;
  for (const auto& [name, place] : points)
    result.push_back({taken<std::string>(name, "the name of a child point"),
                      place.is_none()
                          ? Position()
                          : taken<Position>(place, "a child point's vector of 3 from P [m]")});
  return result;
}

void bind_spring_mass(py::module_& m) {
  py::class_<SpringMass>(
      m, "SpringMass",
      "Spring-mass on one axis: parent_mass m0 [kg] at P, stiffness [N/m] and "
      "damping [N s/m] between P and C, mass [kg] at C. Ports: child C, parent P, "
      "stretch = x_C - x_P [m], position = x_C [m]. States: stretch and its "
      "rate. Every number may be a parameter.")
      .def(py::init([](const Value& mass, const Value& stiffness, const Value& damping,
                       const Value& parent_mass) {
             return SpringMass{mass, stiffness, damping, parent_mass};
           }),
           py::kw_only(), "mass"_a = 1.0, "stiffness"_a = 1.0, "damping"_a = 0.0,
           "parent_mass"_a = 0.0);
  Ports<SpringMass::Handle>(m, "SpringMassPorts", "Ports of a SpringMass in a diagram.")
      .children(&SpringMass::Handle::child, "C, on the mass.")
      .point("parent", &SpringMass::Handle::parent, "P, on the other end of the spring.")
      .read("stretch", &SpringMass::Handle::stretch, "x_C - x_P [m].")
      .read("position", &SpringMass::Handle::position,
            "x_C [m], if the chain to the ground determines it.");
  add_to_diagram<SpringMass>(m);
}

void bind_rigid_body(py::module_& m) {
  py::class_<RigidBody>(
      m, "RigidBody",
      "Rigid body: mass [kg]; inertia about the centre of mass [kg m^2], three principal moments, "
      "six entries (xx, yy, zz, xy, xz, yz) or a 3 x 3 matrix; PA from P to the centre of mass "
      "[m]; children {name: vector from P [m]}. Frame: its own. Every number may be a parameter.")
      .def(py::init([](const Value& mass, const py::object& inertia, const Position& PA,
                       const py::dict& children) {
             RigidBody body{.mass = mass, .PA = PA, .children = child_points(children)};
             if (!inertia.is_none())
               body.inertia = taken<Inertia>(
                   inertia,
                   "an inertia [kg m^2] of three principal moments, six entries (xx, yy, "
                   "zz, xy, xz, yz) or 3 x 3");
             return body;
           }),
           py::kw_only(), "mass"_a = 1.0, "inertia"_a = py::none(),
           "PA"_a = std::vector<double>{0, 0, 0}, "children"_a = py::dict());
  Ports<BodyHandle>(m, "BodyPorts", "Ports of a body in a diagram.")
      .children(&BodyHandle::child, "The child points by name; the only one, if there is one.")
      .point("parent", &BodyHandle::parent, "P.");
  add_to_diagram<RigidBody>(m);
}

void bind_flexible_body(py::module_& m) {
  py::class_<FlexibleBody>(
      m, "FlexibleBody",
      "Flexible body by its modes clamped at P, from ModalData, a Beam, a RigidBody or another "
      "FlexibleBody; checked when it is made, and shared by all blocks that use it. Of modes "
      "(counted from 1) frequencies omega={1: w}, damping ratios xi={1: z}, participations "
      "L_P=[(mode, component, value)] and shapes Phi_C={\"tip\": [(mode, component, value)]} may "
      "be "
      "replaced by numbers or parameters.")
      .def(py::init([](const ModalData& data) { return FlexibleBody(data, here()); }), "data"_a)
      .def(py::init([](const Beam& beam) { return FlexibleBody(beam, here()); }), "data"_a)
      .def(py::init([](const RigidBody& body) { return FlexibleBody(body, here()); }), "data"_a)
      .def(py::init([](const FlexibleBody& body, const std::map<int, Value>& omega,
                       const std::map<int, Value>& xi, const std::vector<ModeEntry>& L_P,
                       const ShapeEntries& Phi_C) {
             ModeValues values{.omega = omega, .xi = xi, .L_P = entries(L_P)};
             for (const auto& [child, list] : Phi_C) values.Phi_C[child] = entries(list);
             return FlexibleBody(body, values);
           }),
           "data"_a, py::kw_only(), "omega"_a = std::map<int, Value>(),
           "xi"_a = std::map<int, Value>(), "L_P"_a = std::vector<ModeEntry>(),
           "Phi_C"_a = ShapeEntries())
      .def("damped_by", &FlexibleBody::damped_by, "Z"_a,
           "The same body with -Z etad (N x N, symmetric, semidefinite [rad/s]) in place of xi.")
      .def("with_loss_factor", &FlexibleBody::with_loss_factor, "eta"_a,
           "The same body with structural damping: stiffness (1 + j eta) K at s = j omega, for "
           "frequency_response(diagram, omega).")
      .def_property_readonly("damping", &FlexibleBody::damping, "N x N [rad/s].")
      .def_property_readonly(
          "data", [](const FlexibleBody& b) { return b.data(); },
          "The modal data as given (a copy).");
  py::implicitly_convertible<ModalData, FlexibleBody>();
  py::implicitly_convertible<Beam, FlexibleBody>();
}

}  // namespace

void bind_bodies(py::module_& m) {
  bind_spring_mass(m);
  bind_rigid_body(m);
  bind_flexible_body(m);
  m.def("rigid_mass", &rigid_mass, "mass"_a, "I_A"_a, "AP"_a,
        "Mass matrix of a rigid body about P (6 x 6): mass [kg], inertia about the centre of mass "
        "A [kg m^2], vector from A to P [m].");
  m.def("tau", &tau, "CP"_a,
        "Kinematic model tau_CP (6 x 6), CP from C to P [m]: xdd_C = tau_CP xdd_P, F_P = tau_CP' "
        "F_C.");
}

}  // namespace titop::python
