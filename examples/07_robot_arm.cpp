// An arm of three flexible links: joints and links are added in a loop, and each joint brings its
// spring, its damper and its motor. From three motor torques to the hand and the joint angles.
#include <Eigen/Geometry>
#include <cstdio>
#include <numbers>
#include <string>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;
using std::numbers::pi;

namespace {

/// One link with the joint before it; the posture turns it against the link before.
struct Link {
  double length, diameter;  ///< [m], of a tube with walls of 10 %
  Vector3d axis;            ///< of the joint, in the link's frame; also the axis of the posture
  double posture;           ///< [rad]
  double k, c;              ///< of the drive [N m/rad], [N m s/rad]
};
const std::array<Link, 3> links{{{0.5, 0.08, {0, 0, 1}, 0.3, 2e4, 20},   // yaw
                                 {0.7, 0.06, {0, 1, 0}, -0.9, 1e4, 10},  // pitch
                                 {0.6, 0.04, {0, 1, 0}, 1.2, 3e3, 2}}};  // pitch

Diagram robot_arm() {
  Diagram d{"robot arm"};
  auto base = d.add("base", RigidBody{.children = {{"J1"}}});
  ground(base);
  auto site = base.child("J1");
  std::vector<Hinge::Handle> joints;
  std::vector<BodyHandle> bodies;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Link& l = links[i];
    const std::string n = std::to_string(i + 1);
    const FlexibleBody tube_body = Beam{.length = l.length,
                                        .section = tube(l.diameter, 0.8 * l.diameter),
                                        .material = {.E = 70e9, .nu = 0.25, .rho = 2700},
                                        .elements = 2};
    bodies.push_back(d.add("link" + n, tube_body));
    joints.push_back(hinge(d, "joint" + n, bodies.back(), i == 0 ? site : bodies[i - 1].child("C"),
                           Rotation::about(l.axis, l.posture), l.axis));
    joints.back().torque =
        l.k * joints.back().angle + l.c * joints.back().rate - d.input("tau" + n);
  }
  d.output("hand", 6) = bodies.back().child("C").accel;  // in the last link's frame
  for (std::size_t i = 0; i < 3; ++i) d.output("theta" + std::to_string(i + 1)) = joints[i].angle;
  return d;
}

/// The same by hand. Coordinates: per link theta, then nodes 1 and 2 relative to its base.
by_hand::Structure by_hand_arm() {
  by_hand::Structure a = by_hand::empty(39, 3, 9);
  by_hand::MatrixXd tip = by_hand::MatrixXd::Zero(6, 39);  // motion of the last tip; the base rests
  for (int i = 0; i < 3; ++i) {
    const Link& l = links[static_cast<std::size_t>(i)];
    const by_hand::Beam beam = by_hand::tube(l.length, l.diameter, 0.8 * l.diameter, 70e9, 2700, 2);
    const by_hand::FreeBeam fe = by_hand::free_beam(beam);
    const Eigen::Matrix3d T_ba = Eigen::AngleAxisd(l.posture, l.axis).matrix();
    by_hand::MatrixXd root = by_hand::dual(T_ba.transpose()) * tip;
    root.block<3, 1>(3, 13 * i) += l.axis;
    by_hand::MatrixXd Y = by_hand::rigid_motion(beam) * root;
    Y.block<12, 12>(6, 13 * i + 1) += by_hand::MatrixXd::Identity(12, 12);
    a.M += Y.transpose() * fe.M * Y;
    a.K.block<12, 12>(13 * i + 1, 13 * i + 1) += fe.K.bottomRightCorner<12, 12>();
    a.K(13 * i, 13 * i) = l.k;
    a.D(13 * i, 13 * i) = l.c;
    a.B(13 * i, i) = 1;
    a.C(6 + i, 13 * i) = 1;
    tip = Y.bottomRows<6>();
  }
  a.C.topRows<6>() = tip;
  return a;
}

}  // namespace

int main() {
  const System system = compile(robot_arm());
  const StateSpace& model = system.state_space();
  const by_hand::Structure a = by_hand_arm();
  std::printf("order %d, %zu inputs, %zu outputs; the slow poles\n", model.order(),
              model.inputs.size(), model.outputs.size());
  auto poles = system.poles();
  std::printf("%s", to_string(std::vector<Pole>(poles.begin(), poles.begin() + 6)).c_str());
  std::vector<by_hand::MatrixXcd> scene, dense, hand;
  for (const double w : {1.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 30000.0}) {
    const by_hand::Complex s{0.1 * w, w};
    scene.push_back(system.transfer(s));
    dense.push_back(model.transfer(s));
    by_hand::MatrixXcd G = by_hand::position_transfer(a, s);
    G.topRows(6) *= s * s;
    hand.push_back(G);
  }
  bool ok =
      by_hand::agrees("transfer against M and K", by_hand::transfer_error(scene, hand), 1e-11);
  ok &= by_hand::agrees("dense model against M and K", by_hand::transfer_error(dense, hand), 1e-9);
  ok &= by_hand::agrees("poles against M and K",
                        by_hand::pole_error(by_hand::moving(poles), by_hand::poles(a)), 1e-9);
  // A torque at rest turns its own joint by tau / k, and no other.
  const Eigen::MatrixXd rest = system.static_gain().bottomRows(3);
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double k = links[static_cast<std::size_t>(i)].k;
      worst = std::max(worst, std::abs(rest(i, j) * k - (i == j ? 1 : 0)));
    }
  ok &= by_hand::agrees("angles at rest: tau / k", worst, 1e-8);
  return ok && model.order() == 78 ? 0 : 1;
}
