#include "signals.hpp"

namespace titop::python {
namespace {

/// A body for the templates of hinge, slide, joint and bushing.
struct MountedBody {
  DualPort<6> parent;
};

MountedBody mounted(const py::object& body) { return {six_axes(point_of(body))}; }

template <class Spec, class Make>
void def_joint(py::module_& m, const char* name, Make make, const char* text) {
  m.def(
      name,
      [make](const DiagramPtr& d, std::string joint, const py::object& body, const TwoWayPort& site,
             const Rotation& T_ba, const Vector3d& axis) {
        return PortsOf<typename Spec::Handle>{
            d, make(*d, std::move(joint), mounted(body), six_axes(site), T_ba, axis, here())};
      },
      "diagram"_a, "name"_a, "body"_a, "site"_a, "T_ba"_a, "axis"_a, text);
}

void bind_hinge(py::module_& m) {
  py::class_<Hinge>(m, "Hinge", "Revolute joint about the vector axis, in the joint's frame.")
      .def(py::init([](const Vector3d& axis) { return Hinge{axis}; }),
           "axis"_a = Vector3d(0, 0, 1));
  Ports<Hinge::Handle>(m, "HingePorts", "Ports of a hinge in a diagram.")
      .children(&Hinge::Handle::child, "Mount of the body.")
      .point("parent", &Hinge::Handle::parent, "Mount of the joint.")
      .driven("accel", &Hinge::Handle::accel, "thetadd [rad/s^2].")
      .driven("torque", &Hinge::Handle::torque,
              "Torque of the body ON its parent about the axis [N m]: k * angle + c * rate is the "
              "stable spring-damper, a motor that exerts tau on the body is -tau.")
      .read("angle", &Hinge::Handle::angle, "theta [rad].")
      .read("rate", &Hinge::Handle::rate, "thetad [rad/s].");
  add_to_diagram<Hinge>(m);
  def_joint<Hinge>(
      m, "hinge", &hinge<MountedBody>,
      "Mounts `body` on `site` through a hinge about `axis` (in the body's frame); T_ba "
      "takes components of the body's frame to those of the site's at angle 0. Drive "
      "its torque or accel.");
}

void bind_slide(py::module_& m) {
  py::class_<Slide>(m, "Slide", "Prismatic joint along the vector axis, in the joint's frame.")
      .def(py::init([](const Vector3d& axis) { return Slide{axis}; }),
           "axis"_a = Vector3d(0, 0, 1));
  Ports<Slide::Handle>(m, "SlidePorts", "Ports of a slide in a diagram.")
      .children(&Slide::Handle::child, "Mount of the body.")
      .point("parent", &Slide::Handle::parent, "Mount of the joint.")
      .driven("accel", &Slide::Handle::accel, "xdd [m/s^2].")
      .driven("force", &Slide::Handle::force, "Force of the body ON its parent along the axis [N].")
      .read("travel", &Slide::Handle::travel, "x [m].")
      .read("rate", &Slide::Handle::rate, "xd [m/s].");
  add_to_diagram<Slide>(m);
  def_joint<Slide>(m, "slide", &slide<MountedBody>,
                   "Mounts `body` on `site` through a slide along `axis` (in the body's frame). "
                   "Drive its force or accel.");
}

void bind_joint(py::module_& m) {
  py::class_<Axis>(m, "Axis", "One degree of freedom of a joint: about(r) or along(r).")
      .def_readonly("direction", &Axis::direction,
                    "Vector of 3 in the joint's frame, any length but 0.")
      .def_readonly("name", &Axis::name, "Of its ports and states; \"\": axis1, axis2, ...");
  m.def("about", &about, "r"_a, "name"_a = "", "A revolute axis about the vector r [rad].");
  m.def("along", &along, "r"_a, "name"_a = "", "A prismatic axis along the vector r [m].");
  m.def("ball", &ball, "Axes rx, ry, rz.");
  m.def("universal", &universal, "r1"_a, "r2"_a, "Axes about r1 and r2.");
  m.def("cylindrical", &cylindrical, "r"_a, "Axes travel and angle.");
  m.def("planar", &planar, "normal"_a, "Axes angle about the normal, axis1 and axis2 across it.");
  py::class_<Joint>(m, "Joint", "Joint with any of the six degrees of freedom free.")
      .def(py::init([](const std::vector<Axis>& axes) { return Joint{axes}; }), "axes"_a);
  Ports<Joint::AxisPorts>(m, "AxisPorts", "Ports of one axis of a joint.")
      .driven("accel", &Joint::AxisPorts::accel, "qdd [m/s^2 or rad/s^2].")
      .driven("force", &Joint::AxisPorts::force, "Of the body ON its parent [N or N m].")
      .read("position", &Joint::AxisPorts::position, "q [m or rad].")
      .read("rate", &Joint::AxisPorts::rate, "qd [m/s or rad/s].");
  Ports<Joint::Handle>(m, "JointPorts", "Ports of a joint in a diagram.")
      .children(&Joint::Handle::child, "Mount of the body.")
      .point("parent", &Joint::Handle::parent, "Mount of the joint.")
      .type()
      .def(
          "axis",
          [](const PortsOf<Joint::Handle>& j, const std::string& name) {
            return PortsOf<Joint::AxisPorts>{j.diagram, j.ports.axis(name)};
          },
          "name"_a, "The axis of this name.");
  add_to_diagram<Joint>(m);
  m.def(
      "joint",
      [](const DiagramPtr& d, const std::string& name, const py::object& body,
         const TwoWayPort& site, const Rotation& T_ba, const std::vector<Axis>& axes) {
        return PortsOf<Joint::Handle>{
            d, joint(*d, name, mounted(body), six_axes(site), T_ba, axes, here())};
      },
      "diagram"_a, "name"_a, "body"_a, "site"_a, "T_ba"_a, "axes"_a,
      "Mounts `body` on `site` through a joint with these free axes (in the body's frame); an axis "
      "without further equations moves freely.");
}

void bind_bushing(py::module_& m) {
  py::class_<Bushing>(m, "Bushing",
                      "Spring-damper of six axes (x, y, z, rx, ry, rz) between two points: "
                      "stiffness [N/m, N, N m/rad] and damping, six values or a 6 x 6 matrix.")
      .def(py::init([](const SixAxes& stiffness, const py::object& damping) {
             return Bushing{stiffness,
                            damping.is_none()
                                ? SixAxes()
                                : taken<SixAxes>(damping, "a damping of six values or 6 x 6")};
           }),
           py::kw_only(), "stiffness"_a, "damping"_a = py::none());
  Ports<Bushing::Handle>(m, "BushingPorts", "Ports of a bushing in a diagram.")
      .point("child", &Bushing::Handle::child, "C, mount of the body.")
      .point("parent", &Bushing::Handle::parent, "P, mount of the bushing.")
      .read("displacement", &Bushing::Handle::displacement, "x_C - x_P [m; rad], 6.")
      .read("rate", &Bushing::Handle::rate, "Its rate [m/s; rad/s], 6.");
  add_to_diagram<Bushing>(m);
  m.def(
      "bushing",
      [](const DiagramPtr& d, const std::string& name, const py::object& body,
         const TwoWayPort& site, const Rotation& T_ba, const Bushing& spec) {
        const DualPort<6> to = six_axes(site);
        if (py::isinstance<TwoWayPort>(body))
          return PortsOf<Bushing::Handle>{
              d, bushing(*d, name, six_axes(body.cast<TwoWayPort>()), to, T_ba, spec, here())};
        return PortsOf<Bushing::Handle>{d,
                                        bushing(*d, name, mounted(body), to, T_ba, spec, here())};
      },
      "diagram"_a, "name"_a, "body"_a, "site"_a, "T_ba"_a, "spec"_a,
      "Mounts `body` on `site` through a bushing; between two points it only adds its force.");
}

void bind_posture(py::module_& m) {
  py::class_<LoopStep>(m, "LoopStep",
                       "A joint of a loop, about(r) or along(r), its angle [rad] or travel [m] if "
                       "given, a guess otherwise, the link to the next joint [m], and its turn.")
      .def(py::init([](const Axis& joint, std::optional<double> given, double guess,
                       const Vector3d& link, const Rotation& turn) {
             return LoopStep{joint, given, guess, link, turn};
           }),
           "joint"_a, py::kw_only(), "given"_a = py::none(), "guess"_a = 0.0,
           "link"_a = Vector3d(0, 0, 0), "turn"_a = Rotation());
  py::class_<Posture>(m, "Posture", "Result of posture; one entry per joint, in order.")
      .def_readonly("values", &Posture::values, "Angles [rad] or travels [m].")
      .def_readonly("T_ba", &Posture::T_ba, "Mounting rotations.")
      .def_readonly("offset", &Posture::offset, "Translations in the joints [m].")
      .def_readonly("gap", &Posture::gap, "Remaining misclosure [m].")
      .def_readonly("gap_angle", &Posture::gap_angle, "Remaining misclosure [rad].");
  m.def(
      "posture",
      [](const std::vector<LoopStep>& loop, double tolerance) {
        return posture(loop, {.tolerance = tolerance});
      },
      "loop"_a, py::kw_only(), "tolerance"_a = 1e-9,
      "Closes a loop of joints and links: finds the values that are not given.");
}

}  // namespace

void bind_joints(py::module_& m) {
  bind_hinge(m);
  bind_slide(m);
  bind_joint(m);
  bind_bushing(m);
  bind_posture(m);
}

}  // namespace titop::python
