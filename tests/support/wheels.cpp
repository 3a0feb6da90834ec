#include "support/wheels.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <string>
#include <titop/titop.hpp>

namespace titop_test {

using namespace titop;
using Eigen::MatrixXd;

namespace {

MatrixXd axes_of(int count) {
  if (count < 4) return MatrixXd::Identity(3, count);
  MatrixXd axes(3, 4);
  axes << 1, 0, -1, 0, 0, 1, 0, -1, 1, 1, 1, 1;
  return axes / std::sqrt(2.0);
}

Rotation to_axis(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d z(0, 0, 1), turn = z.cross(axis);
  if (turn.norm() == 0) return {};
  return Rotation::about(turn / turn.norm(), std::atan2(turn.norm(), z.dot(axis)));
}

}  // namespace

Diagram satellite(const Wheels& w) {
  Diagram d{"wheels"};
  const auto hub = d.add(
      "hub", RigidBody{.mass = 1500,
                       .inertia = {1200, 900, 1100},
                       .children = {{"C", {1, 0, 0}}, {"W", {w.off_centre ? 0.1 : 0.0, 0, 0}}}});
  const auto boom =
      d.add("boom", FlexibleBody{Beam{.length = 3,
                                      .section = tube(0.06, 0.056),
                                      .material = {.E = 120e9, .nu = 0.3, .rho = 1600},
                                      .modes = {.kept = 4, .xi = {0.003}}}});
  mount(boom, hub.child("C"), Rotation::about({0, 0, 1}, 0.4));
  hub.parent.force.linear = 0;
  hub.parent.force.angular = 0;
  const MatrixXd axes = axes_of(w.count), I = MatrixXd::Identity(3, 3);
  const auto add_wheels = [&](const auto& torque, const MatrixXd& share) {
    for (int i = 0; i < w.count; ++i) {
      const std::string n = std::to_string(i + 1);
      const auto wheel = d.add("w" + n, RigidBody{.mass = 6, .inertia = {0.05, 0.05, 0.08}});
      const auto h =
          hinge(d, "spin" + n, wheel, hub.child("W"), to_axis(axes.col(i)), Vector3d(0, 0, 1));
      h.torque = w.friction * h.rate + MatrixXd(share.row(i)) * torque;
      d.output("speed" + n) = h.rate;
    }
  };
  if (w.law) {
    const auto ref = d.input("ref", 3);
    const auto K = d.add("K", Lti{.A = -3 * I, .B = I, .C = (60 - 1500) * 3 * I, .D = 1500 * I});
    K.in = ref - hub.parent.position.angular();
    if (w.count == 0)
      hub.parent.force.angular += -K.out;
    else
      add_wheels(K.out, axes.completeOrthogonalDecomposition().pseudoInverse());
  } else {
    const auto torque = d.input("torque", w.count);
    add_wheels(torque, MatrixXd::Identity(w.count, w.count));
  }
  d.output("att", 3) = hub.parent.position.angular();
  return d;
}

int order_by_momentum(const Wheels& w) {
  if (w.count == 1) return 1 + 4 + 1 + (w.law ? 1 : 0);
  return 3 + 8 + (w.law ? 3 + 3 : w.count);
}

}  // namespace titop_test
