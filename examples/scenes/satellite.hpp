#pragma once

#include <numbers>
#include <titop/titop.hpp>

/// The satellite of the demo: a rigid hub, two booms from real finite-element data, one of them on
/// a hinge with a motor.
namespace scenes {

using titop::Vector3d;

inline const titop::RigidBody hub_spec{
    .mass = 85,  // [kg]
    .inertia = Vector3d(9, 11, 13).asDiagonal(),
    .PA = {0.02, -0.01, 0.05},
    .children = {{"C1", {0.35, 0, 0.1}}, {"C2", {-0.35, 0.05, 0.1}}}};
inline constexpr double kappa = 60, c = 0.8;  // hinge spring [N m/rad] and damper [N m s/rad]
inline const Vector3d hinge_axis(0, 1, 0);    // in the boom's frame: across it
inline const Vector3d turn1(0, 0, 1), turn2(1, 2, 9);
inline constexpr double angle1 = std::numbers::pi / 12, angle2 = 2.9;

/// The beam of examples/data/calculix_beam, 342 modes: six are kept, and the static response to a
/// motion of its root. Damping 0.5 %.
inline const titop::fe::ModeOptions boom_modes{.kept = 6, .residual = {"P"}, .xi = {0.005}};
titop::FlexibleBody read_boom(const titop::fe::ModeOptions& modes = boom_modes);

/// Torque on the hub by its own attitude and rate: -(kp angle + kd rate).
struct AttitudeLaw {
  double kp = 0, kd = 0;  // [N m/rad], [N m s/rad]
};

titop::Diagram satellite(const titop::FlexibleBody& boom, const AttitudeLaw* law = nullptr,
                         double damper = c);

}  // namespace scenes

/// scenes::satellite(scenes::read_boom()): the input of the code generator.
titop::Diagram demo_satellite();
