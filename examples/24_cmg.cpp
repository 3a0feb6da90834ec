// A cluster of four single-gimbal control moment gyroscopes: each is a `Rotor` of constant speed on
// a gimbal that a `hinge` turns about an axis across the rotor's. A gimbal rate turns the momentum
// h and so exerts h times that rate on the hub, about the axis across both. The shaft of the gimbal
// drive is a spring of stiffness k: a slow turn of the hub winds it, and the hub appears heavier by
// h^2 / k about that axis. The same by hand, from M, D, K with the gyroscopic terms in D.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

const Vector3d hub_inertia{120, 140, 100}, cluster_at{0.1, 0, -0.2};
constexpr double hub_mass = 300, rotor_mass = 5, axial = 0.08, transverse = 0.05;  // [kg], [kg m^2]
constexpr double gimbal_mass = 1, gimbal_inertia = 0.01, h = 40;  // [kg], [kg m^2], [N m s]
constexpr double k = 500, c = 0.2;                                // [N m/rad], [N m s/rad]
constexpr int kGyroscopes = 4;

/// Axes of one gyroscope: of its gimbal, of its rotor, and of the torque on the hub per gimbal
/// rate.
struct Axes {
  Vector3d gimbal, rotor, torque;
};

Axes axes(int i) {  // a pyramid about z; without a command the momenta sum to 0
  const double azimuth = i * std::numbers::pi / 2, up = 54.7 * std::numbers::pi / 180;
  const Vector3d out(std::cos(azimuth), std::sin(azimuth), 0),
      side = Vector3d::UnitZ().cross(out),
      gimbal = std::cos(up) * Vector3d::UnitZ() + std::sin(up) * out;
  return {gimbal, side, side.cross(gimbal)};
}

/// Inputs: torque on the hub, torques of the gimbal drives. Outputs: gimbal angles, angular
/// acceleration of the hub.
Diagram cluster() {
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

/// Coordinates: hub 0 to 5, gimbal angles 6 to 9.
by_hand::Structure cluster_by_hand() {
  constexpr by_hand::Index n = 10, first = 6;
  by_hand::Structure a = by_hand::empty(n, 7, 7);
  a.M.topLeftCorner(3, 3).diagonal().setConstant(hub_mass);
  a.M.block(3, 3, 3, 3) = hub_inertia.asDiagonal();
  by_hand::MatrixXd site = by_hand::MatrixXd::Zero(6, n);
  site.leftCols(6) = by_hand::tau(-cluster_at);
  for (int i = 0; i < kGyroscopes; ++i) {
    const Axes x = axes(i);
    by_hand::MatrixXd turn = by_hand::MatrixXd::Zero(3, n);  // of the gimbal
    turn.middleCols(3, 3).setIdentity();
    turn.col(first + i) = x.gimbal;
    Eigen::Matrix3d across;  // rotor axis x
    across << 0, -x.rotor.z(), x.rotor.y(), x.rotor.z(), 0, -x.rotor.x(), -x.rotor.y(), x.rotor.x(),
        0;
    a.M += (gimbal_mass + rotor_mass) * site.topRows(3).transpose() * site.topRows(3);
    a.M += turn.transpose() *
           ((gimbal_inertia + transverse) * Eigen::Matrix3d::Identity() +
            (axial - transverse) * x.rotor * x.rotor.transpose()) *
           turn;
    a.D -= h * turn.transpose() * across * turn;
    a.D(first + i, first + i) += c;
    a.K(first + i, first + i) = k;
    a.B(first + i, 3 + i) = 1;
    a.C(i, first + i) = 1;
  }
  a.B.block(3, 0, 3, 3).setIdentity();
  a.C.block(4, 3, 3, 3).setIdentity();
  return a;
}

double error_by_hand(const System& system) {
  std::vector<by_hand::MatrixXcd> ours, right;
  const by_hand::Structure a = cluster_by_hand();
  for (const by_hand::Complex s : by_hand::ray(0.01, 300, 12)) {
    ours.push_back(system.transfer(s));
    right.push_back(by_hand::accel_transfer(a, s));
    right.back().topRows(4) /= s * s;  // angles
  }
  return by_hand::transfer_error(ours, right);
}

}  // namespace

int main() {
  const System system = compile(cluster());
  double slowest = 0;  // mode of the gimbals: all of them alike, the hub at rest
  for (const Pole& p : system.poles())
    if (slowest == 0 && p.pair) slowest = p.omega;
  std::printf("order %d, slowest gimbal mode %.4f rad/s, sqrt(k / J) %.4f\n",
              system.state_space().order(), slowest, std::sqrt(k / (gimbal_inertia + transverse)));
  const FullCertificate full = certify(system);
  std::printf("passive: %s, reciprocal%s: %s\n", full.passivity.least >= -1e-9 ? "yes" : "no",
              full.reciprocity.reversed ? " with momenta reversed" : "",
              full.reciprocity.asymmetry <= 1e-9 ? "yes" : "no");

  // Far below the poles: the inertia that a torque on the hub meets.
  const Eigen::MatrixXcd slow = system.transfer({0, 1e-3});
  const Eigen::Matrix3d apparent = slow.block(4, 0, 3, 3).real().inverse();
  Eigen::Matrix3d wound = Eigen::Matrix3d::Zero();  // h^2 / k about the torque axes
  for (int i = 0; i < kGyroscopes; ++i)
    wound += h * h / k * axes(i).torque * axes(i).torque.transpose();
  const by_hand::MatrixXd M = cluster_by_hand().M.topLeftCorner(6, 6);
  const Eigen::Matrix3d rigid =  // the hub is free in translation
      M.block(3, 3, 3, 3) -
      M.block(3, 0, 3, 3) * M.topLeftCorner(3, 3).inverse() * M.block(0, 3, 3, 3);
  std::printf("apparent inertia about x: %.4f kg m^2, of which h^2 / k %.4f\n", apparent(0, 0),
              wound(0, 0));
  const bool heavier =
      by_hand::agrees("h^2 / k", (apparent - rigid - wound).norm() / wound.norm(), 1e-5);
  const bool equal = by_hand::agrees("transfers", error_by_hand(system), 1e-9);
  return full.holds() && heavier && equal ? 0 : 1;
}
