#include "signals.hpp"

namespace titop::python {
namespace {

void bind_rotor(py::module_& m) {
  py::class_<Rotor>(
      m, "Rotor",
      "Rotor on a carrier, axisymmetric about `axis`: mass [kg], axial and transverse "
      "inertia about its centre of mass [kg m^2], momentum h [N m s] of its constant "
      "speed, PA from P to the centre of mass [m]. Numbers may be parameters.")
      .def(py::init([](const Value& mass, const Value& axial, const Value& transverse,
                       const Vector3d& axis, const Value& momentum, const Vector3d& PA) {
             return Rotor{mass, axial, transverse, axis, momentum, PA};
           }),
           py::kw_only(), "mass"_a = 1.0, "axial"_a = 1.0, "transverse"_a = 1.0,
           "axis"_a = Vector3d(0, 0, 1), "momentum"_a = 0.0, "PA"_a = Vector3d(0, 0, 0));
  Ports<Rotor::Handle>(m, "RotorPorts", "Ports of a rotor in a diagram.")
      .point("parent", &Rotor::Handle::parent, "P, on the carrier.")
      .driven("accel", &Rotor::Handle::accel, "nud, relative to the carrier [rad/s^2].")
      .driven("torque", &Rotor::Handle::torque,
              "Torque of the rotor ON its carrier [N m]; a motor that exerts tau on the rotor is "
              "-tau.")
      .read("angle", &Rotor::Handle::angle, "Integral of nu [rad].")
      .read("speed", &Rotor::Handle::speed, "nu, change of the speed [rad/s].");
  add_to_diagram<Rotor>(m);
  py::class_<Imbalance>(m, "Imbalance",
                        "Imbalance of a rotor: static_kgm, sum of m e [kg m]; dynamic_kgm2, sum of "
                        "m e z [kg m^2].")
      .def(py::init([](double static_kgm, double dynamic_kgm2) {
             return Imbalance{static_kgm, dynamic_kgm2};
           }),
           py::kw_only(), "static_kgm"_a = 0.0, "dynamic_kgm2"_a = 0.0);
  m.def(
      "unbalance",
      [](const DiagramPtr& d, const PortsOf<Rotor::Handle>& rotor, const std::string& name,
         const Imbalance& imbalance,
         double speed) { unbalance(*d, rotor.ports, name, imbalance, speed, here()); },
      "diagram"_a, "rotor"_a, "name"_a, "imbalance"_a, "speed"_a,
      "Input `name` with the components cos and sin of an imbalance that turns at speed [rad/s].");
}

void bind_slosh(py::module_& m) {
  py::class_<Slosh>(
      m, "Slosh",
      "One lateral mode of a liquid in a tank under thrust along `axis` (in the frame "
      "of the tank): mass [kg], stiffness [N/m], damping [N s/m].")
      .def(py::init([](const Value& mass, const Value& stiffness, const Value& damping,
                       const Vector3d& axis) {
             return Slosh{mass, stiffness, damping, axis};
           }),
           py::kw_only(), "mass"_a = 0.0, "stiffness"_a = 0.0, "damping"_a = 0.0,
           "axis"_a = Vector3d(0, 0, 1));
  m.def(
      "slosh",
      [](const DiagramPtr& d, const std::string& name, const TwoWayPort& site, const Slosh& spec) {
        return PortsOf<Joint::Handle>{d, slosh(*d, name, six_axes(site), spec, here())};
      },
      "diagram"_a, "name"_a, "site"_a, "spec"_a,
      "Puts the mode at this child point of a body; axes \"b\" and \"c\" across the thrust.");
}

}  // namespace

void bind_rotors(py::module_& m) {
  bind_rotor(m);
  bind_slosh(m);
}

}  // namespace titop::python
