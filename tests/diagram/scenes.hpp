#pragma once

#include <numbers>
#include <titop/titop.hpp>

/// The paper's figures, for looking at. Numbers do not matter here.
namespace titop_test {

using namespace titop;

inline Diagram five_masses() {  // Figs. 7, 8
  Diagram d{"five masses"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 1.0, .stiffness = 10.0});
  auto z2 = d.add("z2", SpringMass{.mass = 2.0, .stiffness = 26.0});
  auto z3 = d.add("z3", SpringMass{.mass = 3.0, .stiffness = 33.0});
  auto z4 = d.add("z4", SpringMass{.mass = 4.0, .stiffness = 20.0});
  auto z5 = d.add("z5", SpringMass{.mass = 5.0, .stiffness = 95.0});
  z1.parent.accel = 0;
  z2.parent.accel = z1.child.accel;
  z3.parent.accel = z1.child.accel;
  z4.parent.accel = z2.child.accel;
  z5.parent.accel = z2.child.accel;
  z1.child.force = z2.parent.force + z3.parent.force - u;
  z2.child.force = z4.parent.force + z5.parent.force + u;
  d.output("x3") = z1.stretch + z3.stretch;
  return d;
}

inline Diagram fig12() {  // Figs. 12, 13: both ends inverted
  Diagram d{"Fig. 12"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 3.0, .stiffness = 50.0, .parent_mass = 2.0});
  auto z2 = d.add("z2", SpringMass{.mass = 1.5, .stiffness = 80.0});
  z1.parent.force = -u;
  z2.child.accel = 0;
  z2.parent.accel = z1.child.accel;
  z1.child.force = z2.parent.force;
  d.output("xdd0") = z1.parent.accel;
  d.output("xdd1") = z1.child.accel;
  d.output("f32") = z2.child.force;
  return d;
}

inline RigidBody box(std::vector<ChildPoint> children) {
  return {.mass = 10.0, .children = std::move(children)};
}

inline Diagram spacecraft() {  // Figs. 17, 18
  Diagram d{"spacecraft"};
  const Beam boom{.length = 2.0,
                  .section = rectangle(0.06, 0.04),
                  .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                  .elements = 1};
  auto U = d.input("U", 6);
  auto B = d.add("B", box({{"C1", {1, 0, 0}}, {"C2", {-1, 0, 0}}}));
  auto A1 = d.add("A1", FlexibleBody(boom));
  auto A2 = d.add("A2", FlexibleBody(boom));
  B.parent.force = -U;
  mount(A1, B.child("C1"), Rotation::about({0, 0, 1}, 0.5));
  mount(A2, B.child("C2"), Rotation::about({0, 0, 1}, std::numbers::pi));
  d.output("xdd_P", 6) = B.parent.accel;
  d.output("xdd_F1", 6) = A1.child.accel;
  d.output("xdd_F2", 6) = A2.child.accel;
  return d;
}

inline Diagram robot_joint() {  // Figs. 19, 20: a hinge with a local mechanism and a motor
  Diagram d{"robot joint"};
  auto tau = d.input("tau");
  auto k = d.param("k", 30.0);
  auto B = d.add("B", box({{"C1", {1, 0, 0}}}));
  auto A = d.add("A", box({{"F", {2, 0, 0}}}));
  release(B);
  auto h = hinge(d, "drive", A, B.child("C1"), Rotation::about({0, 0, 1}, 0.5), {0, 0, 1});
  h.torque = k * h.angle + 0.2 * h.rate - tau;
  d.output("theta") = h.angle;
  d.output("xdd_F", 6) = A.child.accel;
  return d;
}

/// A controller of named blocks, a part that no input reaches, an unobservable mass, a pin.
inline Diagram controlled() {
  Diagram d{"controlled"};
  auto r = d.input("r");
  auto z1 = d.add("z1", SpringMass{.mass = 3.0, .stiffness = 50.0});
  auto z2 = d.add("z2", SpringMass{.mass = 1.0, .stiffness = 80.0});
  auto lone = d.add("lone", SpringMass{});
  auto error = d.add("error", Sum{.signs = "+-"});
  auto K = d.add("K", Gain{.gain = 12.0});
  auto I = d.add("I", Integrator{});
  ground(z1);
  z2.parent.accel = z1.child.accel;
  ground(lone);
  error.in(1) = r;
  error.in(2) = z1.position;
  K.in = error.out;
  I.in = error.out;
  z1.child.force = K.out + 3.0 * I.out;
  d.output("position") = z1.position;
  return d;
}

/// A body held at its parent point in translation only.
inline Diagram pinned() {
  Diagram d{"pinned"};
  auto U = d.input("U", 6);
  auto B = d.add("B", box({{"C1", {1, 0, 0}}}));
  B.parent.accel.linear = 0;
  B.parent.force.angular = 0;
  B.child("C1").force = U;
  d.output("hold", 3) = B.parent.force.linear;
  d.output("turn", 3) = 2.0 * B.child.accel.angular;
  return d;
}

}  // namespace titop_test
