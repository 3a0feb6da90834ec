#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <titop/titop.hpp>
#include <vector>

/// The satellite with two wings of three modes, of which the hub's mass m, the tilt of both wings,
/// and the first frequency w and damping ratio x of both are parameters.
namespace lft_test {

using namespace titop;

/// `unit`: of masses, in kg.
inline ModalData wing_data(bool symmetric, double unit) {
  ModalData data;
  data.omega = Eigen::Vector3d(1.57, 3.77, 6.91);
  data.xi = Eigen::Vector3d::Constant(0.005);
  data.L_P.resize(3, 6);
  data.L_P << 0, 0, 6.5, 0, -21, 0, 0, 5.8, 0, 0, 0, 19, 0, 0, 0, 3.9, 0, symmetric ? 0 : 0.5;
  data.L_P /= std::sqrt(unit);
  data.D_P = rigid_mass(60 / unit, Matrix3d(Vector3d(20, 180, 200).asDiagonal()) / unit,
                        Vector3d(-2.5, 0, 0));
  return data;
}

/// Forces and torques on the hub to its accelerations about these axes (0 to 5).
struct Satellite {
  std::vector<int> axes = {0, 1, 2, 3, 4, 5};
  bool symmetric = false;  ///< no coupling of twist and bending, wings at the height of the hub
  double mass = 1000, tilt = 0.4, omega = 1.57, xi = 0.005;
  std::vector<std::string> names = {"m", "tilt", "w", "x"};
  std::string prefix = {};  ///< of all nodes
  bool rates = false;       ///< also the hub's rate and position, in the frame of a wing
  double unit = 1;          ///< of masses, in kg

  Diagram diagram() const {
    Diagram d{"N17"};
    const Param m = d.param(names[0], mass / unit), t = d.param(names[1], tilt),
                w = d.param(names[2], omega), x = d.param(names[3], xi);
    const double high = symmetric ? 0 : 0.2;
    auto hub = d.add(prefix + "hub",
                     RigidBody{.mass = m,
                               .inertia = Matrix3d(Vector3d(400, 500, 600).asDiagonal()) / unit,
                               .children = {{"L", {0, 1, high}}, {"R", {0, -1, high}}}});
    const FlexibleBody wing{wing_data(symmetric, unit)};
    const ModeValues values{.omega = {{1, w}}, .xi = {{1, x}}};
    auto left = d.add(prefix + "left", FlexibleBody{wing, values});
    auto right = d.add(prefix + "right", FlexibleBody{wing, values});
    const Vector3d up(0, 0, 1), along(1, 0, 0);
    const double right_angle = std::numbers::pi / 2;
    mount(left, hub.child("L"), Rotation::about(up, right_angle) * Rotation::about(along, t));
    mount(right, hub.child("R"), Rotation::about(up, -right_angle) * Rotation::about(along, t));
    Eigen::MatrixXd pick = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(axes.size()));
    for (std::size_t i = 0; i < axes.size(); ++i) pick(axes[i], static_cast<Eigen::Index>(i)) = 1;
    const int n = static_cast<int>(axes.size());
    auto u = d.input("U", n);
    hub.parent.force = Eigen::MatrixXd(-pick) * u;
    d.output("y", n) = Eigen::MatrixXd(pick.transpose()) * hub.parent.accel;
    if (rates) {
      d.output("rate", 6) = left.parent.rate;
      d.output("position", 6) = left.parent.position;
    }
    return d;
  }
};

inline ParameterRanges ranges(const Satellite& s = {}) {
  return {{s.names[0], percent(50)},
          {s.names[1], between(s.tilt - 2.8, s.tilt + 2.8)},
          {s.names[2], percent(30)},
          {s.names[3], percent(100 * (1 - 1e-9))}};
}

}  // namespace lft_test
