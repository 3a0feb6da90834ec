// Reaction wheels with momentum: a hub with a boom, turned by four wheels in a pyramid under an
// attitude law. Each wheel is a `Rotor`: its spin is a channel, and its momentum at constant speed
// acts on the hub by the gyroscopic torque h a x omega. With momenta the wheels stiffen the hub
// like a spinning top: a torque about one axis turns it about another. The same by hand, from M, D,
// K with the antisymmetric gyroscopic terms in D; the certificate checks the structure without the
// law with all momenta reversed.
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/wheels.hpp"

using namespace titop;
using namespace scenes::wheels;

namespace {

/// Coordinates: hub 0 to 5, nodes of the boom 6 to 17, angles of the wheels 18 to 21. Outputs: the
/// wheels' angles, the hub's; the law acts through the angles of the wheels.
by_hand::Structure satellite_by_hand(double momentum, bool law) {
  constexpr by_hand::Index n = 22, first = 18;
  by_hand::Structure a = by_hand::empty(n, 3, 7);
  a.M.topLeftCorner(3, 3).diagonal().setConstant(hub_mass);
  a.M.block(3, 3, 3, 3) = hub_inertia.asDiagonal();
  const by_hand::Beam beam = by_hand::tube(boom_length, 0.05, 0.046, 70e9, 2700, 2);
  const by_hand::FreeBeam fe = by_hand::free_beam(beam);
  by_hand::MatrixXd root = by_hand::MatrixXd::Zero(6, n), site = root;
  root.leftCols(6) = by_hand::tau(-boom_at);
  site.leftCols(6) = by_hand::tau(-wheel_at);
  by_hand::MatrixXd nodes = by_hand::rigid_motion(beam) * root;
  nodes.block<12, 12>(6, 6) += by_hand::MatrixXd::Identity(12, 12);
  a.M += nodes.transpose() * fe.M * nodes;
  a.K.block<12, 12>(6, 6) += fe.K.bottomRightCorner<12, 12>();
  const Eigen::MatrixXd share = allocation();
  for (int i = 0; i < kWheels; ++i) {
    const Vector3d s = spin_axis(i);
    by_hand::MatrixXd spin = by_hand::MatrixXd::Zero(1, n);  // about the axis, with the hub's turn
    spin.middleCols(3, 3) = s.transpose();
    spin(0, first + i) = 1;
    a.M += wheel_mass * site.topRows(3).transpose() * site.topRows(3);
    a.M.block(3, 3, 3, 3) += transverse * (Eigen::Matrix3d::Identity() - s * s.transpose());
    a.M += axial * spin.transpose() * spin;
    Eigen::Matrix3d turn;  // momentum s x
    turn << 0, -s.z(), s.y(), s.z(), 0, -s.x(), -s.y(), s.x(), 0;
    a.D.block(3, 3, 3, 3) -= momentum * turn;
    a.D(first + i, first + i) = friction;
    if (law) a.D.block(first + i, 3, 1, 3) = -law_c * share.row(i);
    if (law) a.K.block(first + i, 3, 1, 3) = -law_k * share.row(i);
    a.C(i, first + i) = 1;
  }
  a.B.middleRows(3, 3).setIdentity();
  a.C.block(4, 3, 3, 3).setIdentity();
  return a;
}

double error_by_hand(const System& system, double momentum, bool law) {
  std::vector<by_hand::MatrixXcd> ours, right;
  for (const by_hand::Complex s : by_hand::ray(0.01, 30, 12)) {
    ours.push_back(system.transfer(s));
    right.push_back(by_hand::accel_transfer(satellite_by_hand(momentum, law), s));
    right.back().topRows(4) /= s;  // speeds
  }
  return by_hand::transfer_error(ours, right);
}

}  // namespace

int main() {
  bool ok = true;
  for (const double momentum : {0.0, 40.0}) {
    const System free = compile(satellite(momentum, false));
    double nutation = 0;  // the slowest pole that oscillates
    for (const Pole& p : free.poles())
      if (nutation == 0 && p.pair && p.omega > 0.1) nutation = p.omega;
    std::printf(
        "momentum %.0f N m s in each wheel, motors off: order %d, slowest oscillation %.4f rad/s\n",
        momentum, free.state_space().order(), nutation);
    const FullCertificate c = certify(free);
    std::printf("passive: %s, reciprocal%s: %s\n", c.passivity.least >= -1e-9 ? "yes" : "no",
                c.reciprocity.reversed ? " with momenta reversed" : "",
                c.reciprocity.asymmetry <= 1e-9 ? "yes" : "no");
    ok = c.holds() && ok;
    const System held = compile(satellite(momentum, true));
    double slowest = -HUGE_VAL;
    for (const Pole& p : held.poles())
      if (p.omega > 1e-9) slowest = std::max(slowest, p.s.real());
    std::printf("with the law: order %d, %s\n", held.state_space().order(),
                slowest < 0 ? "stable" : "not stable");
    ok = slowest < 0 && ok;
    ok = by_hand::agrees("motors off", error_by_hand(free, momentum, false), 1e-9) && ok;
    ok = by_hand::agrees("with the law", error_by_hand(held, momentum, true), 1e-9) && ok;
    const auto turned = free.transfer({0, 1e-3}).bottomRows(3).eval();
    std::printf(
        "at 0.001 rad/s 1 N m about x turns the hub with %.4f, %.4f, %.4f rad/s about x, y, z\n\n",
        std::abs(turned(0, 0)) / 1e-3, std::abs(turned(1, 0)) / 1e-3,
        std::abs(turned(2, 0)) / 1e-3);
  }
  return ok ? 0 : 1;
}
