// A spacecraft is written as it is built: add the bodies, mount them, declare inputs and outputs.
// The bus, free under U, gets its parent channel inverted by that alone (Figs. 17, 18).
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cstdio>
#include <numbers>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;
using std::numbers::pi;

namespace {

Diagram spacecraft(const FlexibleBody& bus, const FlexibleBody& wing, const Rotation& T_ba1,
                   const Rotation& T_ba2) {
  Diagram d{"spacecraft"};
  auto U = d.input("U", 6);  // wrench on B at P, in frame b [N; N m]
  auto B = d.add("B", bus);
  auto A1 = d.add("A1", wing);
  auto A2 = d.add("A2", wing);
  B.parent.force = -U;              // P is free: this channel gets inverted
  mount(A1, B.child("C1"), T_ba1);  // same motion there, wrench back here
  mount(A2, B.child("C2"), T_ba2);
  d.output("xdd_P", 6) = B.parent.accel;
  d.output("xdd_F1", 6) = A1.child("F").accel;
  d.output("xdd_F2", 6) = A2.child("F").accel;
  return d;
}

/// Tube of aluminium, 3 m long, two elements, all its twelve modes.
FlexibleBody make_wing() {
  ModalData data = modal_data(Beam{.length = 3,
                                   .section = tube(0.05, 0.045),
                                   .material = {.E = 70e9, .nu = 0.25, .rho = 2700},
                                   .elements = 2});
  data.children.front().name = "F";  // its free end
  return data;
}

RigidBody make_bus(const Vector3d& PA, const Vector3d& C1, const Vector3d& C2) {
  return {.mass = 120,  // [kg]
          .inertia = Vector3d(20, 25, 30).asDiagonal(),
          .PA = PA,
          .children = {{"C1", C1}, {"C2", C2}}};
}

// --- the same by hand ----------------------------------------------------------------------------

/// Coordinates: motion of P (6), then the motion of nodes 1 and 2 of each wing relative to it (12
/// each, in the wing's frame).
by_hand::Structure by_hand_spacecraft(const Vector3d& PA, const std::array<Vector3d, 2>& C,
                                      const std::array<Eigen::Matrix3d, 2>& T_ba) {
  const by_hand::Beam wing = by_hand::tube(3, 0.05, 0.045, 70e9, 2700, 2);
  const by_hand::FreeBeam fe = by_hand::free_beam(wing);

  by_hand::Structure a = by_hand::empty(30, 6, 18);
  Vector6 bus;
  bus << 120, 120, 120, 20, 25, 30;
  const by_hand::Matrix6 tau_AP = by_hand::tau(-PA);
  a.M.topLeftCorner<6, 6>() = tau_AP.transpose() * bus.asDiagonal() * tau_AP;
  a.B.topRows<6>().setIdentity();
  a.C.topLeftCorner<6, 6>().setIdentity();
  for (int i = 0; i < 2; ++i) {
    const auto k = static_cast<std::size_t>(i);
    // Motion of the wing's 18 degrees of freedom: carried along by P, and its own.
    by_hand::MatrixXd Y = by_hand::MatrixXd::Zero(18, 30);
    Y.leftCols<6>() =
        by_hand::rigid_motion(wing) * by_hand::dual(T_ba[k].transpose()) * by_hand::tau(-C[k]);
    Y.block<12, 12>(6, 6 + 12 * i).setIdentity();
    a.M += Y.transpose() * fe.M * Y;
    a.K.block<12, 12>(6 + 12 * i, 6 + 12 * i) += fe.K.bottomRightCorner<12, 12>();
    a.C.middleRows<6>(6 + 6 * i) = Y.bottomRows<6>();
  }
  return a;
}

bool compare(const System& system, const by_hand::Structure& a) {
  std::vector<by_hand::MatrixXcd> scene, dense, hand;
  for (const double w : {1.0, 20.0, 60.0, 200.0, 500.0, 2000.0, 10000.0}) {
    const by_hand::Complex s{0.1 * w, w};
    scene.push_back(system.transfer(s));
    dense.push_back(system.state_space().transfer(s));
    hand.push_back(by_hand::accel_transfer(a, s));
  }
  bool ok = by_hand::agrees("  transfer against M and K",
                            by_hand::transfer_error(scene, hand, 3, 3), 1e-12);
  ok &= by_hand::agrees("  dense model against M and K", by_hand::transfer_error(dense, hand, 3, 3),
                        1e-10);
  const by_hand::MatrixXd at_rest = a.M.topLeftCorner<6, 6>().inverse();
  const by_hand::MatrixXd gain = system.static_gain().topRows(6);
  ok &= by_hand::agrees("  static gain: inverse of the total rigid mass",
                        by_hand::transfer_error({gain.cast<by_hand::Complex>()},
                                                {at_rest.cast<by_hand::Complex>()}, 3, 3),
                        1e-12);
  return ok;
}

}  // namespace

int main() {
  const FlexibleBody wing = make_wing();
  bool ok = true;

  // Two wings somewhere, turned anyhow.
  const Vector3d PA(0.1, -0.05, 0.2), C1(0.5, 0.3, -0.1), C2(-0.4, 0.2, 0.3);
  const Vector3d axis1 = Vector3d::UnitZ(), axis2(1, 2, -1);
  const System skew = compile(spacecraft(make_bus(PA, C1, C2), wing, Rotation::about(axis1, 0.4),
                                         Rotation::about(axis2, 2.5)));
  const by_hand::Structure a =
      by_hand_spacecraft(PA, {C1, C2},
                         {Eigen::AngleAxisd(0.4, axis1).matrix(),
                          Eigen::AngleAxisd(2.5, axis2.normalized()).matrix()});
  std::printf("two rotations: order %d, from M and K %d\n", skew.state_space().order(),
              by_hand::least_order(a));
  ok &= skew.state_space().order() == by_hand::least_order(a);
  ok &= compare(skew, a);
  ok &= by_hand::agrees(
      "  poles against M and K",
      by_hand::pole_error(by_hand::moving(skew.poles()), by_hand::poles(by_hand::elastic(a, 6))),
      1e-10);
  std::printf("  lowest frequencies [Hz]:");
  const auto poles = skew.poles();
  for (std::size_t i = 0; i < 6; ++i) std::printf(" %.5f", poles[i].hertz);
  std::printf("\n\n");

  // Mounted symmetrically. Stretching and twisting in opposite phase leave the bus at rest, and
  // only those: opposite bending turns it. No input moves them, so they are not in the model.
  const Vector3d right(0.5, 0, 0), left(-0.5, 0, 0);
  const System symmetric = compile(spacecraft(make_bus(Vector3d::Zero(), right, left), wing, {},
                                              Rotation::about({0, 0, 1}, pi)));
  const by_hand::Structure b = by_hand_spacecraft(
      Vector3d::Zero(), {right, left},
      {Eigen::Matrix3d::Identity(), Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix()});
  std::printf("symmetric: order %d of %d, from M and K %d\n", symmetric.state_space().order(),
              symmetric.order(), by_hand::least_order(b));
  ok &= symmetric.state_space().order() == by_hand::least_order(b);
  ok &= compare(symmetric, b);
  return ok ? 0 : 1;
}
