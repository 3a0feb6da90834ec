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
inline constexpr double dumped = 0.01;  // torquers: torque per momentum of the wheels [1/s]
inline constexpr int kWheels = 4;
// A plate of the wheels on springs [kg], [kg m^2]; [N/m], [N m/rad].
inline constexpr double plate_mass = 10, plate_inertia = 0.4, mount_k = 2e5, mount_turn_k = 2e4;
inline constexpr double mount_c = 100, mount_turn_c = 4;  // [N s/m], [N m s/rad]
inline constexpr Imbalance imbalance{.static_kgm = 7e-6, .dynamic_kgm2 = 2e-7};

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

enum class Motors {
  off,
  law,     ///< turn the hub back
  dumping  ///< the law, and torquers on the hub that take momentum out of the wheels
};

/// A wheel at `site`: its motor; its speed is an output, or its imbalance at 1 rad/s an input.
inline void add_wheel(Diagram& d, int i, const BodyHandle& hub, const DualPort<6>& site,
                      const Value& momentum, Motors motors, bool vibration) {
  const std::string number = std::to_string(i + 1);
  auto wheel = d.add("w" + number, Rotor{.mass = wheel_mass,
                                         .axial = axial,
                                         .transverse = transverse,
                                         .axis = spin_axis(i),
                                         .momentum = momentum});
  mount(wheel, site);
  wheel.torque = friction * wheel.speed;  // `torque` is that of the rotor on its carrier
  if (motors != Motors::off) {
    const Eigen::MatrixXd share = allocation().row(i);
    wheel.torque += Eigen::MatrixXd(-law_k * share) * hub.parent.position.angular() +
                    Eigen::MatrixXd(-law_c * share) * hub.parent.rate.angular();
  }
  if (motors == Motors::dumping)
    hub.parent.force.angular += Eigen::MatrixXd(dumped * axial * spin_axis(i)) * wheel.speed;
  if (vibration)
    unbalance(d, wheel, "imbalance" + number, imbalance, 1);
  else
    d.output("speed" + number) = wheel.speed;
}

/// The wheels' plate on its springs.
inline BodyHandle isolated_plate(Diagram& d, const BodyHandle& hub) {
  auto plate = d.add("plate", RigidBody{.mass = plate_mass,
                                        .inertia = plate_inertia * Matrix3d::Identity(),
                                        .children = {{"wheels"}}});
  bushing(d, "isolator", plate, hub.child("wheels"), {},
          {.stiffness = {mount_k, mount_k, mount_k, mount_turn_k, mount_turn_k, mount_turn_k},
           .damping = {mount_c, mount_c, mount_c, mount_turn_c, mount_turn_c, mount_turn_c}});
  return plate;
}

/// The parameter h is the momentum of each wheel [N m s]. `vibration`: the wheels stand on a plate
/// on springs; inputs are their imbalances, and their speeds are no outputs.
inline Diagram satellite(double momentum, Motors motors, bool vibration = false) {
  Diagram d{"satellite"};
  const Param h = d.param("h", momentum);
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
  const DualPort<6> site =
      vibration ? isolated_plate(d, hub).child("wheels") : DualPort<6>(hub.child("wheels"));
  for (int i = 0; i < kWheels; ++i) add_wheel(d, i, hub, site, h, motors, vibration);
  d.output("turn", 3) = hub.parent.accel.angular;
  return d;
}

}  // namespace scenes::wheels
