#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <titop/titop.hpp>

/// Diagram and numbers of examples/24_cmg.cpp.
namespace scenes::cmg {

using namespace titop;

inline const Vector3d hub_inertia{120, 140, 100}, cluster_at{0.1, 0, -0.2};
inline constexpr double hub_mass = 300, rotor_mass = 5, axial = 0.08,
                        transverse = 0.05;                               // [kg], [kg m^2]
inline constexpr double gimbal_mass = 1, gimbal_inertia = 0.01, h = 40;  // [kg], [kg m^2], [N m s]
inline constexpr double k = 500, c = 0.2;                                // [N m/rad], [N m s/rad]
inline constexpr int kGyroscopes = 4;

/// Axes of one gyroscope: of its gimbal, of its rotor, and of the torque on the hub per gimbal
/// rate.
struct Axes {
  Vector3d gimbal, rotor, torque;
};

inline Axes axes(int i) {  // a pyramid about z; without a command the momenta sum to 0
  const double azimuth = i * std::numbers::pi / 2, up = 54.7 * std::numbers::pi / 180;
  const Vector3d out(std::cos(azimuth), std::sin(azimuth), 0),
      side = Vector3d::UnitZ().cross(out),
      gimbal = std::cos(up) * Vector3d::UnitZ() + std::sin(up) * out;
  return {gimbal, side, side.cross(gimbal)};
}

/// Inputs: torque on the hub, torques of the gimbal drives. Outputs: gimbal angles, angular
/// acceleration of the hub.
inline Diagram cluster() {
  Diagram d{"cluster"};
  auto U = d.input("U", 3);
  auto hub = d.add("hub", RigidBody{.mass = hub_mass,
                                    .inertia = hub_inertia.asDiagonal(),
                                    .children = {{"cluster", cluster_at}}});
  hub.parent.force.angular += -U;
  release(hub);
  for (int i = 0; i < kGyroscopes; ++i) {
    const std::string number = std::to_string(i + 1);
    auto gimbal =
        d.add("gimbal" + number, RigidBody{.mass = gimbal_mass,
                                           .inertia = gimbal_inertia * Eigen::Matrix3d::Identity(),
                                           .children = {{"rotor"}}});
    auto rotor = d.add("rotor" + number, Rotor{.mass = rotor_mass,
                                               .axial = axial,
                                               .transverse = transverse,
                                               .axis = axes(i).rotor,
                                               .momentum = h});
    auto drive = hinge(d, "drive" + number, gimbal, hub.child("cluster"), {}, axes(i).gimbal);
    mount(rotor, gimbal.child("rotor"));
    drive.torque = k * drive.angle + c * drive.rate - d.input("u" + number);
    rotor.accel = 0;  // its speed is held
    d.output("angle" + number) = drive.angle;
  }
  d.output("turn", 3) = hub.parent.accel.angular;
  return d;
}

}  // namespace scenes::cmg
