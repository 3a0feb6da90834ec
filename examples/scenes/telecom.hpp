#pragma once

#include <titop/titop.hpp>

/// A telecommunication satellite: a hub with liquid in a tank, two wings of three panels on yokes
/// from finite-element data, turned by drives, three wheels, of which one has momentum, and the law
/// that turns the hub by them.
namespace scenes::telecom {

using titop::Vector3d;

inline const titop::RigidBody hub_spec{.mass = 1800,
                                       .inertia = Vector3d(1500, 900, 1700).asDiagonal(),
                                       .children = {{"north", {0, 1.1, 0.1}},
                                                    {"south", {0, -1.1, 0.1}},
                                                    {"tank", {0, 0, -0.5}},
                                                    {"wheels", {0.3, 0, 0.4}}}};
inline const titop::Plate panel{.a = 1.5,
                                .b = 2.4,
                                .thickness = 0.02,
                                .material = {.rho = 150},
                                .D = titop::PlateStiffness{900, 270, 600, 250},
                                .elements = {4, 6}};
inline constexpr double hinge_k = 60, hinge_c = 0.3;  ///< between panels [N m/rad], [N m s/rad]
inline constexpr double drive_k = 900, drive_c = 1;   ///< holding torque [N m/rad], [N m s/rad]
inline constexpr double wheel_mass = 6, wheel_axial = 0.06, wheel_transverse = 0.035;
inline constexpr double wheel_momentum = 20;  ///< of the wheel about y [N m s]
inline const titop::Slosh liquid{.mass = 120, .stiffness = 20, .damping = 1.5};

inline const Vector3d kp(30, 20, 35), kd(300, 190, 340);  ///< per axis [N m/rad], [N m s/rad]
inline constexpr double lag = 4;                          ///< of the law's two filters [rad/s]
inline constexpr double period = 0.1;                     ///< of the law on board [s]

/// (kp + kd s) / (s / lag + 1)^2 per axis, from angles to torques.
titop::Lti law_block();

/// The yoke from its mesh: its lowest modes, and residual vectors of its tip.
titop::FlexibleBody read_yoke();

/// A panel between its two long edges, which are stiff, with its lowest modes.
titop::FlexibleBody sandwich_panel();

/// Inputs T (3), a disturbing torque on the hub, and command (3), torques on the hub by the wheels;
/// output attitude (3). The law acts with a factor, the parameter "gain"; its torques are the loop
/// point "torque".
titop::Diagram satellite(const titop::FlexibleBody& yoke, double factor = 1);

}  // namespace scenes::telecom

/// The law alone, from "attitude" to "command": the input of the code generator.
titop::Diagram telecom_attitude_law();
