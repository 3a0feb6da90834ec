#pragma once

#include <cmath>
#include <titop/titop.hpp>

/// Diagrams and numbers of examples/26_sloshing.cpp.
namespace scenes::sloshing {

using namespace titop;

inline const Vector3d hub_inertia{400, 420, 300},
    liquid_at{0.1, 0, -0.4};                                        // centre of the liquid at rest
inline constexpr double hub_mass = 500, m = 60, g = 0.05, l = 0.3;  // [kg], [m/s^2], [m]
inline constexpr double k = m * g / l, xi = 0.005;                  // [N/m]
inline const double c = 2 * xi * std::sqrt(k * m);                  // [N s/m]

/// A pendulum that hangs from `site`, a length l ahead of the liquid.
inline void pendulum(Diagram& d, const DualPort<6>& site) {
  auto bob = d.add("bob", RigidBody{.mass = m, .inertia = Matrix3d::Zero(), .PA = {0, 0, -l}});
  auto pivot = joint(d, "pivot", bob, site, {}, {about({1, 0, 0}, "x"), about({0, 1, 0}, "y")});
  for (const char* axis : {"x", "y"})
    pivot.axis(axis).force =
        k * l * l * pivot.axis(axis).position + c * l * l * pivot.axis(axis).rate;
}

enum class Liquid { springs, pendulum };

inline Diagram satellite(Liquid model) {
  Diagram d{"satellite"};
  auto U = d.input("U", 6);
  auto hub = d.add("hub", RigidBody{.mass = hub_mass,
                                    .inertia = hub_inertia.asDiagonal(),
                                    .children = {{"liquid", liquid_at},
                                                 {"pivot", liquid_at + Vector3d(0, 0, l)}}});
  hub.parent.force = -U;
  if (model == Liquid::springs)
    slosh(d, "liquid", hub.child("liquid"), {.mass = m, .stiffness = k, .damping = c});
  else
    pendulum(d, hub.child("pivot"));
  d.output("accel", 6) = hub.parent.accel;
  return d;
}

}  // namespace scenes::sloshing
