#pragma once

#include <titop/titop.hpp>

/// A satellite with a solar array: hub, yoke, three sandwich panels on spring hinges along their
/// whole edges. The panels' interfaces either follow their nodes or constrain them.
namespace scenes::solar_array {

using namespace titop;

/// The mesh of a panel, the modes that are kept and the polynomials of its edges.
struct Detail {
  std::array<int, 2> elements = {4, 6};
  std::optional<int> kept = {};
  int polynomials = 3;
};

constexpr int kPanels = 3;
constexpr double hinge_k = 60, hinge_c = 0.3;  // [N m/rad], [N m s/rad]
inline const Vector3d array_at(0.7, 0, 0);     // of the yoke, from the hub's centre of mass [m]

inline RigidBody hub_spec() {
  return {.mass = 450,
          .inertia = Vector3d(160, 140, 180).asDiagonal(),
          .children = {{"array", array_at}}};
}
inline Beam yoke_spec() {
  return {.length = 0.9,
          .section = tube(0.06, 0.056),
          .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
          .elements = 2};
}

/// Parent "yoke" along the middle third of its edge, or "inner" along all of it; child "outer".
inline fe::Mesh panel_mesh(bool first, Lumping lumping, const Detail& detail) {
  fe::Mesh mesh = plate_mesh({.a = 1.5,
                              .b = 2.4,
                              .thickness = 0.02,
                              .material = {.rho = 150},
                              .D = PlateStiffness{900, 270, 600, 250},
                              .elements = detail.elements});
  const auto line = [&](const std::string& edge) {
    const fe::Legendre polynomials = fe::legendre(detail.polynomials);
    return lumping == Lumping::constrained ? fe::shapes(fe::edge(mesh, edge), polynomials)
                                           : fe::moments(fe::edge(mesh, edge), polynomials);
  };
  const fe::NodeSet third = fe::segment(mesh, "x0", 1.0 / 3, 2.0 / 3);
  if (first)
    mesh = fe::with_interface(
        mesh, "yoke", lumping == Lumping::constrained ? fe::rigid(third) : fe::average(third));
  else
    mesh = fe::with_interface(mesh, "inner", line("x0"));
  return fe::with_interface(mesh, "outer", line("x1"));
}

inline FlexibleBody panel_body(bool first, Lumping lumping, const Detail& detail) {
  const std::string parent = first ? "yoke" : "inner";
  fe::ModeOptions modes{.kept = detail.kept};
  if (detail.kept) modes.residual = {parent, "outer"}, modes.xi = {0.002};
  return fe::modal_data(panel_mesh(first, lumping, detail), parent, {"outer"}, modes);
}

/// Wrench W on the hub; its acceleration.
inline Diagram satellite(Lumping lumping, const Detail& detail) {
  Diagram d{"satellite"};
  auto W = d.input("W", 6);
  auto hub = d.add("hub", hub_spec());
  auto yoke = d.add("yoke", FlexibleBody{yoke_spec()});
  auto p1 = d.add("p1", panel_body(true, lumping, detail));
  mount(yoke, hub.child("array"));
  mount(p1, yoke.child);
  const FlexibleBody panel = panel_body(false, lumping, detail);
  auto p2 = d.add("p2", panel);
  auto p3 = d.add("p3", panel);
  auto h1 = hinge_line(d, "h1", p2.line("inner"), p1.line("outer"));
  auto h2 = hinge_line(d, "h2", p3.line("inner"), p2.line("outer"));
  h1.torque = hinge_k * h1.angle + hinge_c * h1.rate;
  h2.torque = hinge_k * h2.angle + hinge_c * h2.rate;
  hub.parent.force = -W;
  d.output("hub", 6) = hub.parent.accel;
  return d;
}

}  // namespace scenes::solar_array
