#pragma once

// A free hub with a boom that moves relative to it by S q: the same scene for every joint, and its
// M, D and K assembled by hand.
#include <Eigen/Geometry>

#include "scenes/by_hand.hpp"

namespace joint_test {

using namespace scenes_test;
using titop::Matrix3d;
using titop::Matrix6;
using titop::Vector3d;

constexpr double kMass = 40;                // of the hub [kg]
inline const Vector3d kInertia(3, 4, 5);    // about its centre of mass [kg m^2]
inline const Vector3d kPC(0.4, -0.1, 0.3);  // where the boom is mounted, from P [m]
inline const Vector3d kTurn(1, 2, -1);      // mounting: by kAngle about it
constexpr double kAngle = 0.7;              // [rad]
inline const Tube kBoom{1.1, 0.05, 0.04, 2};

inline titop::RigidBody hub() {
  return {.mass = kMass, .inertia = kInertia.asDiagonal(), .children = {{"C", kPC}}};
}
inline titop::Rotation mounting() { return titop::Rotation::about(kTurn, kAngle); }

/// Inputs: wrench on the hub at P, on the tip of the boom, generalized forces on q. Outputs:
/// accelerations of P, of the tip, q (as accelerations).
inline by_hand::Structure assemble(const MatrixXd& S, const MatrixXd& K, const MatrixXd& C) {
  const by_hand::Beam beam = kBoom.numbers();
  const by_hand::FreeBeam fe = by_hand::free_beam(beam);
  const Index k = S.cols(), own = 6 * kBoom.elements, n = 6 + k + own;
  by_hand::Structure a = by_hand::empty(n, 12 + k, 12 + k);
  a.M.topLeftCorner(3, 3).diagonal().setConstant(kMass);
  a.M.block(3, 3, 3, 3).diagonal() = kInertia;
  MatrixXd root = MatrixXd::Zero(6, n);
  root.leftCols(6) =
      by_hand::dual(Eigen::AngleAxisd(kAngle, kTurn.normalized()).matrix().transpose()) *
      by_hand::tau(-kPC);
  root.middleCols(6, k) = S;
  MatrixXd Y = by_hand::rigid_motion(beam) * root;
  Y.block(6, 6 + k, own, own) += MatrixXd::Identity(own, own);
  a.M += Y.transpose() * fe.M * Y;
  a.K.block(6, 6, k, k) = K;
  a.D.block(6, 6, k, k) = C;
  a.K.bottomRightCorner(own, own) += fe.K.bottomRightCorner(own, own);
  a.C.topLeftCorner(6, 6).setIdentity();
  a.C.middleRows(6, 6) = Y.bottomRows(6);
  a.C.block(12, 6, k, k).setIdentity();
  a.B = a.C.transpose();
  return a;
}

/// The library's side of it: a diagram with hub and boom, inputs W and F, outputs P and tip.
struct Setup {
  titop::Diagram d{"hub and boom"};
  titop::InputRef W = d.input("W", 6), F = d.input("F", 6);
  titop::BodyHandle hub = d.add("hub", joint_test::hub());
  titop::BodyHandle boom = d.add("boom", titop::FlexibleBody{kBoom.beam()});
  Setup() {
    hub.parent.force = -W;
    boom.child.force = F;
    d.output("P", 6) = hub.parent.accel;
    d.output("tip", 6) = boom.child.accel;
  }
};

inline const std::vector<Complex> kPoints = points({3, 20, 90, 400, 2000, 20000});

/// Transfer by hand, the rows from 12 on (q) as positions.
inline std::vector<MatrixXcd> exact_transfers(const by_hand::Structure& a) {
  std::vector<MatrixXcd> list;
  for (const Complex s : kPoints) {
    MatrixXcd G = by_hand::accel_transfer(a, s);
    G.bottomRows(G.rows() - 12) /= s * s;
    list.push_back(G);
  }
  return list;
}

/// These columns and rows only.
inline std::vector<MatrixXcd> part(std::vector<MatrixXcd> list, const std::vector<Index>& rows,
                                   const std::vector<Index>& cols) {
  for (MatrixXcd& G : list) G = MatrixXcd(G(rows, cols));
  return list;
}

inline std::vector<Index> first(Index n) {
  std::vector<Index> list;
  for (Index i = 0; i < n; ++i) list.push_back(i);
  return list;
}

}  // namespace joint_test
