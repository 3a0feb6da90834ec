// A hinge adds one channel, (acceleration, torque) about its axis: torque = 0 leaves it free,
// accel = u drives it, torque = K(s) of its own angle and rate is a mechanism (Figs. 19, 20).
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <numbers>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;
using std::numbers::pi;

namespace {

enum class Mechanism { free, driven, motor, controller };

constexpr double k = 800, c = 6;  // spring [N m/rad] and damper [N m s/rad] of the motor
constexpr double gain = 900, lead = 12,
                 corner = 150;       // controller: gain + lead s / (1 + s / corner)
const Vector3d axis(0, 1, 0);        // of the elbow, in the forearm's frame
constexpr double elbow_angle = 0.8;  // posture, about y [rad]

Beam arm(double length) {
  return {.length = length,
          .section = tube(0.04, 0.03),
          .material = {.E = 70e9, .nu = 0.25, .rho = 2700},
          .elements = 2};
}

Diagram robot(Mechanism kind) {
  Diagram d{"robot"};
  auto W = d.input("W", 6);  // wrench on the hand, in the forearm's frame
  auto upper = d.add("upper", FlexibleBody{arm(0.8)});
  auto forearm = d.add("forearm", FlexibleBody{arm(0.6)});
  auto elbow = hinge(d, "elbow", forearm, upper.child, Rotation::about(axis, elbow_angle), axis);
  ground(upper);
  forearm.child.force = W;
  d.output("xdd", 6) = forearm.child.accel;

  switch (kind) {
    case Mechanism::free: elbow.torque = 0; break;
    case Mechanism::driven:
      elbow.accel = d.input("thetadd");  // the angle follows a given motion ...
      d.output("C_m") = elbow.torque;    // ... and this torque is required
      break;
    case Mechanism::motor:  // gear and friction, and the motor's torque u
      elbow.torque = k * elbow.angle + c * elbow.rate - d.input("u");
      break;
    case Mechanism::controller: {
      auto K = d.add("K", Lti{.A = Eigen::MatrixXd::Constant(1, 1, -corner),
                              .B = Eigen::MatrixXd::Constant(1, 1, corner),
                              .C = Eigen::MatrixXd::Constant(1, 1, -lead * corner),
                              .D = Eigen::MatrixXd::Constant(1, 1, gain + lead * corner)});
      K.in = elbow.angle;
      elbow.torque = K.out - d.input("u");
      break;
    }
  }
  if (kind != Mechanism::driven) d.output("theta") = elbow.angle;
  return d;
}

// --- the same by hand ----------------------------------------------------------------------------

/// Coordinates: theta, nodes 1 and 2 of the upper arm, nodes 1 and 2 of the forearm relative to its
/// base. Inputs: W, and the torque of the joint on the forearm. Outputs: the hand, theta.
by_hand::Structure by_hand_robot() {
  const by_hand::Beam upper = by_hand::tube(0.8, 0.04, 0.03, 70e9, 2700, 2);
  const by_hand::Beam forearm = by_hand::tube(0.6, 0.04, 0.03, 70e9, 2700, 2);
  const by_hand::FreeBeam fe1 = by_hand::free_beam(upper), fe2 = by_hand::free_beam(forearm);

  by_hand::Structure a = by_hand::empty(25, 7, 7);
  a.M.block<12, 12>(1, 1) += fe1.M.bottomRightCorner<12, 12>();
  a.K.block<12, 12>(1, 1) += fe1.K.bottomRightCorner<12, 12>();
  by_hand::MatrixXd base = by_hand::MatrixXd::Zero(6, 25);  // motion of the forearm's base
  base.block<3, 1>(3, 0) = axis;
  const Eigen::Matrix3d T_ba = Eigen::AngleAxisd(elbow_angle, axis).matrix();
  base.block<6, 6>(0, 7) = by_hand::dual(T_ba.transpose());
  by_hand::MatrixXd Y = by_hand::rigid_motion(forearm) * base;
  Y.block<12, 12>(6, 13) += by_hand::MatrixXd::Identity(12, 12);
  a.M += Y.transpose() * fe2.M * Y;
  a.K.block<12, 12>(13, 13) += fe2.K.bottomRightCorner<12, 12>();
  a.C.topRows<6>() = Y.bottomRows<6>();
  a.C(6, 0) = 1;
  a.B.leftCols<6>() = a.C.topRows<6>().transpose();
  a.B(0, 6) = 1;
  return a;
}

by_hand::MatrixXcd hand_transfer(Mechanism kind, by_hand::Complex s) {
  by_hand::Structure a = by_hand_robot();
  if (kind == Mechanism::motor) a.K(0, 0) += k, a.D(0, 0) += c;
  if (kind == Mechanism::driven) {
    // theta is given: the other coordinates feel -M_q,theta thetadd, and the row of theta gives the
    // joint's torque on the forearm, -C_m.
    by_hand::Structure q = by_hand::empty(24, 7, 7);
    q.M = a.M.bottomRightCorner(24, 24);
    q.K = a.K.bottomRightCorner(24, 24);
    q.B = a.B.bottomRows(24);
    q.B.rightCols(1) = -a.M.block(1, 0, 24, 1);
    q.C.topRows(6) = a.C.block(0, 1, 6, 24);
    q.C.bottomRows(1) = -a.M.block(0, 1, 1, 24);
    by_hand::MatrixXcd G = by_hand::accel_transfer(q, s);
    G.topRightCorner(6, 1) += a.C.block(0, 0, 6, 1);
    G.bottomLeftCorner(1, 6) += a.B.block(0, 0, 1, 6);
    G(6, 6) -= a.M(0, 0);
    return G;
  }
  by_hand::MatrixXcd G = by_hand::position_transfer(a, s);
  if (kind == Mechanism::controller) {  // close u -> theta with -K(s)
    const by_hand::Complex K = gain + lead * s / (1.0 + s / corner);
    const by_hand::MatrixXcd column = G.col(6) * (K / (1.0 + K * G(6, 6)));
    G -= column * G.row(6).eval();
  }
  G.topRows(6) *= s * s;
  return kind == Mechanism::free ? by_hand::MatrixXcd(G.leftCols(6)) : G;
}

std::vector<by_hand::Complex> hand_poles(Mechanism kind) {
  by_hand::Structure a = by_hand_robot();
  if (kind == Mechanism::free) return by_hand::poles(by_hand::elastic(a, 1));
  if (kind == Mechanism::motor) a.K(0, 0) += k, a.D(0, 0) += c;
  if (kind == Mechanism::driven) {
    by_hand::Structure q = by_hand::empty(24, 0, 0);
    q.M = a.M.bottomRightCorner(24, 24);
    q.K = a.K.bottomRightCorner(24, 24);
    return by_hand::poles(q);
  }
  if (kind == Mechanism::motor) return by_hand::poles(a);
  // Controller: one state more, x_K' = corner (theta - x_K).
  const by_hand::Index n = 25;
  by_hand::MatrixXd A = by_hand::MatrixXd::Zero(2 * n + 1, 2 * n + 1);
  a.K(0, 0) += gain + lead * corner;
  const Eigen::LLT<by_hand::MatrixXd> M(a.M);
  A.block(0, n, n, n).setIdentity();
  A.block(n, 0, n, n) = -M.solve(a.K);
  A.block(n, 2 * n, n, 1) = M.solve(a.B.col(6)) * (lead * corner);
  A(2 * n, 0) = corner;
  A(2 * n, 2 * n) = -corner;
  return by_hand::poles(A);
}

}  // namespace

int main() {
  bool ok = true;
  for (const auto& [kind, name, order] :
       {std::tuple{Mechanism::free, "free", 50}, std::tuple{Mechanism::driven, "driven", 48},
        std::tuple{Mechanism::motor, "spring, damper and motor", 50},
        std::tuple{Mechanism::controller, "controller", 51}}) {
    const System system = compile(robot(kind));
    const StateSpace& model = system.state_space();
    const auto poles = system.poles();
    const auto damped =
        std::count_if(poles.begin(), poles.end(), [](const Pole& p) { return p.damping > 1e-6; });
    const auto growing =
        std::count_if(poles.begin(), poles.end(), [](const Pole& p) { return p.damping < -1e-6; });
    std::printf("%s: order %d, %ld poles are damped, %ld grow\n", name, model.order(),
                static_cast<long>(damped), static_cast<long>(growing));
    std::vector<by_hand::MatrixXcd> scene, dense, hand;
    for (const double w : {3.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 30000.0}) {
      const by_hand::Complex s{0.1 * w, w};
      scene.push_back(system.transfer(s));
      dense.push_back(model.transfer(s));
      hand.push_back(hand_transfer(kind, s));
    }
    ok &=
        by_hand::agrees("  transfer against M and K", by_hand::transfer_error(scene, hand), 1e-11);
    ok &= by_hand::agrees("  dense model against M and K", by_hand::transfer_error(dense, hand),
                          1e-8);
    ok &= by_hand::agrees("  poles against M and K",
                          by_hand::pole_error(by_hand::moving(poles), hand_poles(kind)), 1e-9);
    ok &= model.order() == order;
    std::printf("  slowest [rad/s, damping]:");
    int shown = 0;
    for (const Pole& p : poles)
      if (p.omega > 0 && ++shown <= 4)
        std::printf(" %.5g (%.4f)", p.omega, std::abs(p.damping) < 1e-6 ? 0 : p.damping);
    std::printf("\n");
  }
  return ok ? 0 : 1;
}
