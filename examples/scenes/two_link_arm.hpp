#pragma once

#include <titop/titop.hpp>

/// The arm of examples/29_exact_beam.cpp.
namespace scenes::two_link_arm {

using namespace titop;

inline const ExactBeam upper{.length = 3,
                             .section = tube(0.08, 0.07),
                             .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                             .damping = {.mass = 0.02, .stiffness = 2e-5}};
inline const ExactBeam lower{.length = 2,
                             .section = tube(0.05, 0.042),
                             .material = upper.material,
                             .damping = upper.damping};
inline const Scene band{.band_hz = {0, 50}};

/// The arm on a free hub, with links of any kind; the elbow is a hinge on a spring.
template <class Link>
Diagram arm(Link upper_link, Link lower_link) {
  Diagram d{"arm"};
  auto hub = d.add("hub", RigidBody{.mass = 60,
                                    .inertia = Vector3d(5, 6, 7).asDiagonal(),
                                    .children = {{"arm", {0.4, 0, 0}}}});
  auto inner = d.add("upper", upper_link), outer = d.add("lower", lower_link);
  auto hand = d.add("hand", RigidBody{.mass = 3, .inertia = 0.02 * Matrix3d::Identity()});
  hub.parent.force = -d.input("F", 6);  // [N; N m]
  mount(inner, hub.child("arm"));
  const Vector3d z(0, 0, 1);
  auto elbow = hinge(d, "elbow", outer, inner.child("C"), Rotation::about(z, 0.7), z);
  elbow.torque = 900 * elbow.angle + 4 * elbow.rate;
  mount(hand, outer.child("C"));
  d.output("hub", 6) = hub.parent.accel;
  d.output("hand", 6) = hand.parent.accel;
  return d;
}

/// The same with links of so many elements, and these modes of each.
inline Diagram arm_of(int elements, const fe::ModeOptions& modes = {}) {
  return arm(FlexibleBody{with_elements(upper, elements, modes)},
             FlexibleBody{with_elements(lower, elements, modes)});
}

}  // namespace scenes::two_link_arm
