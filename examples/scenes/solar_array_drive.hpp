#pragma once

#include <numbers>
#include <string>
#include <titop/titop.hpp>

/// Diagram and numbers of examples/25_solar_array_drive.cpp.
namespace scenes::solar_array_drive {

using namespace titop;

inline const Vector3d hub_inertia{200, 180, 220}, array_at{0, 0.8, 0};
inline constexpr double hub_mass = 400;  // [kg]
inline constexpr double panel_mass = 8, panel_width = 1.6,
                        panel_length = 1.2;  // [kg], [m]: along y, x
inline constexpr double panel_k = 1500,
                        panel_c = 1.5;  // hinges of the panels, [N m/rad], [N m s/rad]
inline const Vector3d panel_centre{0.15, panel_width / 2, 0};  // off the drive's axis [m]
inline constexpr double detent_k = 0.8, detent_c = 2e-4;  // of the motor, [N m/rad], [N m s/rad]
inline constexpr double step = 1.8 * std::numbers::pi / 180;  // of the motor [rad]
inline constexpr int kPanels = 3;

/// A plate in the x-y plane about its centre.
inline Vector3d panel_inertia() {
  const double x = panel_length * panel_length / 12, y = panel_width * panel_width / 12;
  return panel_mass * Vector3d(y, x, x + y);
}

struct ArrayDrive {
  double tilt = 0, gear = 100, motor_inertia = 2e-5;  // [rad], N [-], J_m [kg m^2]
  ParameterList list() const { return {{"tilt", tilt}, {"N", gear}, {"J_m", motor_inertia}}; }
};

/// Turned about y by the tilt; the panels bend about their hinges along x.
inline Diagram satellite() {
  Diagram d{"satellite"};
  const ArrayDrive nominal;
  const Param tilt = d.param("tilt", nominal.tilt), N = d.param("N", nominal.gear),
              J_m = d.param("J_m", nominal.motor_inertia);
  auto command = d.input("command");  // angle of the motor [rad]
  auto hub = d.add("hub", RigidBody{.mass = hub_mass,
                                    .inertia = hub_inertia.asDiagonal(),
                                    .children = {{"array", array_at}}});
  hub.parent.force = 0;
  const RigidBody panel{.mass = panel_mass,
                        .inertia = panel_inertia().asDiagonal(),
                        .PA = panel_centre,
                        .children = {{"next", {0, panel_width, 0}}}};
  auto inner = d.add("panel1", panel);
  auto drive =
      hinge(d, "drive", inner, hub.child("array"), Rotation::about({0, 1, 0}, tilt), {0, 1, 0});
  // Of the motor, which turns with the hub and N times the drive: its inertia and its detent.
  const auto inertia = J_m * (hub.parent.accel.angular.along({0, 1, 0}) + N * drive.accel);
  const auto detent = N * (detent_c * drive.rate + detent_k * drive.angle) - detent_k * command;
  drive.torque = N * (inertia + detent);
  hub.parent.force.angular.along({0, 1, 0}) += inertia;
  for (int i = 2; i <= kPanels; ++i) {
    auto outer = d.add("panel" + std::to_string(i), panel);
    auto joint = hinge(d, "hinge" + std::to_string(i), outer, inner.child("next"), {}, {1, 0, 0});
    joint.torque = panel_k * joint.angle + panel_c * joint.rate;
    inner = outer;
  }
  d.output("turn", 3) = hub.parent.accel.angular;
  return d;
}

}  // namespace scenes::solar_array_drive
