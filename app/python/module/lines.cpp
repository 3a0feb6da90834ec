#include "signals.hpp"

namespace titop::python {
namespace {

/// A line of a body in a diagram.
struct BodyLine {
  DiagramPtr diagram;
  LinePort line;
};

/// The shape "z2" of this line: the second degree of z.
DualPort<1> shape_of(const LinePort& line, const std::string& name) {
  std::string names;
  for (std::size_t i = 0; i < line.line.shapes.size(); ++i) {
    const std::string here_is = to_string(line.line.shapes[i]);
    if (here_is == name) return line.shape_ports[i];
    names += (names.empty() ? "" : ", ") + here_is;
  }
  throw Error(Code::unknown_name, "line " + line.name + " has no shape " + name,
              "its shapes are " + names);
}

void bind_line_port(py::module_& m) {
  py::class_<BodyLine>(m, "LinePort",
                       "An edge of a flexible body as an interface: the six channels at its "
                       "middle, and one scalar channel for each of its shapes.")
      .def_property_readonly(
          "name", [](const BodyLine& l) { return l.line.name; }, "Block and line, \"p1.next\".")
      .def_property_readonly(
          "point", [](const BodyLine& l) { return TwoWayPort(l.diagram, l.line.point); },
          "The child at its middle, or the parent.")
      .def_property_readonly(
          "is_parent", [](const BodyLine& l) { return l.line.is_parent; }, "The body hangs on it.")
      .def_property_readonly(
          "axis", [](const BodyLine& l) { return l.line.line.axis; },
          "Body axis along which it runs: 0, 1, 2.")
      .def_property_readonly(
          "length", [](const BodyLine& l) { return l.line.line.length; }, "[m]")
      .def_property_readonly(
          "shapes",
          [](const BodyLine& l) {
            std::vector<std::string> names;
            for (const LineShape& shape : l.line.line.shapes) names.push_back(to_string(shape));
            return names;
          },
          "\"z2\": displacement z by the Legendre polynomial of degree 2; \"ry1\": rotation.")
      .def(
          "shape",
          [](const BodyLine& l, const std::string& name) {
            return TwoWayPort(l.diagram, shape_of(l.line, name));
          },
          "name"_a, "The channel of this shape, of one axis.");
}

/// Before the functions of points, whose first argument is any object.
void bind_line_mounting(py::module_& m) {
  m.def(
      "mount",
      [](const BodyLine& line, const TwoWayPort& site, const Rotation& T_ba) {
        mount(line.line, six_axes(site), T_ba, here());
      },
      "line"_a, "site"_a, "T_ba"_a = Rotation(), py::prepend(),
      "Fixes a whole line, its body's parent, to a rigid point: its shapes are at 0.");
  m.def(
      "ground", [](const BodyLine& line) { ground(line.line, here()); }, "line"_a, py::prepend(),
      "Fixes a whole line to the inertial frame: its point, and its shapes at 0.");
  m.def(
      "weld",
      [](const BodyLine& line, const TwoWayPort& site, const Rotation& T_ba) {
        weld(line.line, six_axes(site), T_ba, here());
      },
      "line"_a, "site"_a, "T_ba"_a = Rotation(),
      "Fixes a whole line, of a child too, to a rigid point, as for closing a chain.");
  m.def(
      "weld",
      [](const BodyLine& a, const BodyLine& b, const Rotation& T_ba) {
        weld(a.line, b.line, T_ba, here());
      },
      "a"_a, "b"_a, "T_ba"_a = Rotation(),
      "Fixes line a to line b along their whole length: equal motion of every shape.");
}

}  // namespace

void bind_lines(py::module_& m) {
  bind_line_port(m);
  bind_line_mounting(m);
  using Handle = FlexibleBodyHandle;
  Ports<Handle>(m, "FlexibleBodyPorts", "Ports of a flexible body in a diagram.")
      .children<6>(&Handle::child, "The child points by name; the only one, if there is one.")
      .point<6>("parent", &Handle::parent, "P.")
      .type()
      .def(
          "line",
          [](const PortsOf<Handle>& body, const std::string& name) {
            return BodyLine{body.diagram, body.ports.line(name)};
          },
          "name"_a, "The line of this name, of a child or of the parent.");
  add_to_diagram<FlexibleBody>(m);
}

void bind_hinge_line(py::module_& m) {
  m.def(
      "hinge_line",
      [](const DiagramPtr& d, const std::string& name, const BodyLine& a, const BodyLine& b,
         const Rotation& T_ba) {
        return PortsOf<Hinge::Handle>{d, hinge_line(*d, name, a.line, b.line, T_ba, here())};
      },
      "diagram"_a, "name"_a, "a"_a, "b"_a, "T_ba"_a = Rotation(),
      "A hinge along the whole line, as between solar panels: a, its body's parent, turns about "
      "the line against b. Drive its torque or accel.");
}

}  // namespace titop::python
