#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <titop/titop.hpp>

/// Diagram and numbers of examples/22_wheels.cpp.
namespace scenes::wheels {

using namespace titop;

inline const Vector3d hub_inertia{120, 140, 100}, boom_at{0.5, 0, 0.3}, wheel_at{0.1, 0, -0.2};
inline constexpr double hub_mass = 300, wheel_mass = 5, axial = 0.08,
                        transverse = 0.05;                 // [kg], [kg m^2]
inline constexpr double boom_length = 4, friction = 1e-3;  // [m], [N m s/rad]
inline constexpr double law_k = 4, law_c = 40;             // [N m/rad], [N m s/rad]
inline constexpr int kWheels = 4;

inline Vector3d spin_axis(int i) {  // pyramid about z, 35 degrees above the x-y plane
  const double azimuth = (2 * i + 1) * std::numbers::pi / 4, up = 35 * std::numbers::pi / 180;
  return {std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth), std::sin(up)};
}

/// Torques of the wheels' motors that turn the hub by a given torque: the pseudo-inverse of the
/// axes, whose pyramid makes A A' diagonal.
inline Eigen::MatrixXd allocation() {
  Eigen::MatrixXd A(3, kWheels);
  for (int i = 0; i < kWheels; ++i) A.col(i) = spin_axis(i);
  return A.transpose() * (A * A.transpose()).diagonal().cwiseInverse().asDiagonal();
}

/// `momentum` of each wheel [N m s]; `law`: else the motors' torques are inputs.
inline Diagram satellite(double momentum, bool law) {
  Diagram d{"satellite"};
  auto U = d.input("U", 3);  // torque of disturbances
  auto hub = d.add("hub", RigidBody{.mass = hub_mass,
                                    .inertia = hub_inertia.asDiagonal(),
                                    .children = {{"boom", boom_at}, {"wheels", wheel_at}}});
  auto boom = d.add("boom", FlexibleBody{Beam{.length = boom_length,
                                              .section = tube(0.05, 0.046),
                                              .material = {.E = 70e9, .nu = 0.25, .rho = 2700},
                                              .elements = 2}});
  mount(boom, hub.child("boom"));
  hub.parent.force.angular += -U;
  release(hub);
  const Eigen::MatrixXd share = allocation();
  for (int i = 0; i < kWheels; ++i) {
    const std::string name = "w" + std::to_string(i + 1);
    auto wheel = d.add(name, Rotor{.mass = wheel_mass,
                                   .axial = axial,
                                   .transverse = transverse,
                                   .axis = spin_axis(i),
                                   .momentum = momentum});
    mount(wheel, hub.child("wheels"));
    const Eigen::MatrixXd row = share.row(i);
    if (law)  // `torque` is that of the rotor on the hub
      wheel.torque = friction * wheel.speed +
                     Eigen::MatrixXd(-law_k * row) * hub.parent.position.angular() +
                     Eigen::MatrixXd(-law_c * row) * hub.parent.rate.angular();
    else
      wheel.torque = friction * wheel.speed;
    d.output("speed" + std::to_string(i + 1)) = wheel.speed;
  }
  d.output("turn", 3) = hub.parent.accel.angular;
  return d;
}

}  // namespace scenes::wheels
