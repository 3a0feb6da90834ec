// A cluster of four single-gimbal control moment gyroscopes: each is a `Rotor` of constant speed on
// a gimbal that a `hinge` turns about an axis across the rotor's. A gimbal rate turns the momentum
// h and so exerts h times that rate on the hub, about the axis across both. The shaft of the gimbal
// drive is a spring of stiffness k: a slow turn of the hub winds it, and the hub appears heavier by
// h^2 / k about that axis. The same by hand, from M, D, K with the gyroscopic terms in D.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/cmg.hpp"

using namespace titop;
using namespace scenes::cmg;

namespace {

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
