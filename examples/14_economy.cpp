// No more than the scene needs: two beams of 60 modes each on a rigid hub, one of them on a spring
// hinge. Asked is what a wheel on the hub and the hinge motor do to the hub and to one tip, up to
// 100 Hz, to one part in a thousand. Out comes a small model with a bound on its error.
#include <Eigen/Geometry>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

const RigidBody hub_spec{.mass = 85,  // [kg]
                         .inertia = Vector3d(9, 11, 13).asDiagonal(),
                         .PA = {0.02, -0.01, 0.05},
                         .children = {{"C1", {0.35, 0, 0.1}}, {"C2", {-0.35, 0.05, 0.1}}}};
constexpr double kappa = 60, c = 0.8;  // hinge spring [N m/rad] and damper [N m s/rad]
const Vector3d hinge_axis(0, 1, 0), turn1(0, 0, 1), turn2(1, 2, 9);
constexpr double angle1 = 0.26, angle2 = 2.9;

FlexibleBody boom() {
  return Beam{.length = 2,
              .section = rectangle(0.06, 0.04),
              .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
              .elements = 10,
              .modes = {.xi = {0.005}}};
}

Diagram satellite(const FlexibleBody& beam) {
  Diagram d{"satellite"};
  auto W = d.input("W", 6);       // wrench on the hub at P [N; N m]
  auto tau_m = d.input("tau_m");  // torque of the motor on boom 2 [N m]
  auto hub = d.add("hub", hub_spec);
  auto boom1 = d.add("boom1", beam), boom2 = d.add("boom2", beam);
  hub.parent.force = -W;
  mount(boom1, hub.child("C1"), Rotation::about(turn1, angle1));
  auto drive =
      hinge(d, "drive", boom2, hub.child("C2"), Rotation::about(turn2, angle2), hinge_axis);
  drive.torque = kappa * drive.angle + c * drive.rate - tau_m;
  d.output("hub", 6) = hub.parent.accel;  // [m/s^2; rad/s^2]
  d.output("tip2", 6) = boom2.child("C").accel;
  d.output("theta") = drive.angle;  // [rad]
  return d;
}

/// The same by hand in the coordinates [P; theta; eta1; eta2]; accelerations are read as positions.
by_hand::Structure by_hand_satellite(const ModalData& boom) {
  const Eigen::Index N = boom.omega.size(), n = 7 + 2 * N;
  by_hand::Structure a = by_hand::empty(n, 7, 13);
  const by_hand::Matrix6 tau_AP = by_hand::tau(-hub_spec.PA);
  by_hand::Matrix6 hub = by_hand::Matrix6::Zero();
  hub.topLeftCorner<3, 3>().diagonal().setConstant(85);
  hub.bottomRightCorner<3, 3>() = hub_spec.inertia;
  a.M.topLeftCorner<6, 6>() = tau_AP.transpose() * hub * tau_AP;
  by_hand::MatrixXd own(6 + N, 6 + N);
  own << boom.D_P, boom.L_P.transpose(), boom.L_P, by_hand::MatrixXd::Identity(N, N);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::Matrix3d T_ba = i == 0 ? Eigen::AngleAxisd(angle1, turn1.normalized()).matrix()
                                        : Eigen::AngleAxisd(angle2, turn2.normalized()).matrix();
    by_hand::MatrixXd Y = by_hand::MatrixXd::Zero(6 + N, n);
    Y.topLeftCorner<6, 6>() = by_hand::dual(T_ba.transpose()) *
                              by_hand::tau(-hub_spec.children[static_cast<std::size_t>(i)].PC);
    if (i == 1) Y.block<3, 1>(3, 6) = hinge_axis;
    Y.block(6, 7 + i * N, N, N).setIdentity();
    a.M += Y.transpose() * own * Y;
    a.K.diagonal().segment(7 + i * N, N) = boom.omega.cwiseAbs2();
    a.D.diagonal().segment(7 + i * N, N) = 2 * boom.xi.cwiseProduct(boom.omega);
    by_hand::MatrixXd tip(6, 6 + N);
    tip << by_hand::tau(-boom.children[0].PC), boom.children[0].Phi_C;
    if (i == 1) a.C.middleRows<6>(6) = tip * Y;
  }
  a.K(6, 6) = kappa;
  a.D(6, 6) = c;
  a.C.topLeftCorner<6, 6>().setIdentity();
  a.C(12, 6) = 1;
  a.B.topLeftCorner<7, 7>().setIdentity();
  return a;
}

/// Largest error of any pair, each over its own peak, beside the scene assembled by hand.
double error_by_hand(const ReducedSystem& r, const by_hand::Structure& a, const Scene& scene) {
  const Eigen::Index rows = static_cast<Eigen::Index>(r.outputs().size());
  by_hand::MatrixXd worst = by_hand::MatrixXd::Zero(rows, 2), peak = worst;
  const double zeta = scene.damping_floor, high = 2 * 3.141592653589793 * scene.band_hz[1];
  for (int k = 1; k <= 400; ++k) {
    const double w = high * k / 400;
    const by_hand::Complex s{zeta * w, std::sqrt(1 - zeta * zeta) * w};
    by_hand::MatrixXcd G = by_hand::position_transfer(a, s);
    G.topRows(12) *= s * s;
    by_hand::MatrixXcd asked(rows, 2);
    asked << G.middleRows(3, 3).col(5), G.middleRows(3, 3).col(6), G.bottomRows(7).col(5),
        G.bottomRows(7).col(6);
    worst = worst.cwiseMax((asked - r.transfer(s)).cwiseAbs());
    peak = peak.cwiseMax(asked.cwiseAbs());
  }
  return worst.cwiseQuotient(peak).maxCoeff();
}

}  // namespace

int main() {
  const FlexibleBody beam = boom();
  const Diagram d = satellite(beam);
  const Scene scene{.inputs = {"W(6)", "tau_m"},
                    .outputs = {"hub(4)", "hub(5)", "hub(6)", "tip2", "theta"},
                    .band_hz = {0, 100},
                    .accuracy = 1e-3};
  const ReducedSystem r = compile(d, scene);
  std::printf("%s: %d states answer what %d states were asked\n", d.name().c_str(), r.order(),
              r.full().order());
  for (const EconomyStep& s : r.steps())
    std::printf("  %s: %d -> %d coordinates, %s\n", s.name.c_str(), s.before, s.after,
                s.error == 0 ? "exact" : s.text.c_str());
  bool ok = r.bound().worst <= scene.accuracy;
  std::printf("bound below 1e-3: %s\n", ok ? "yes" : "NO");
  ok &= by_hand::agrees("against M, D and K by hand",
                        error_by_hand(r, by_hand_satellite(beam.data()), scene), 1e-3);

  std::printf("\nkept modes below 120 Hz\n");
  for (const KeptMode& m : r.modes()) {
    if (m.hertz >= 120) continue;
    std::printf("  %8.3f Hz ", m.hertz);
    for (const auto& [name, share] : m.blocks)
      std::printf(" %s %.0f %%", name.c_str(), 100 * share);
    std::printf("\n");
  }

  std::printf("\naccuracy  states\n");
  const std::vector<double> accuracies{1e-1, 1e-2, 1e-3, 1e-4, 1e-5};
  for (const WhatIf& w : what_if(d, scene, accuracies))
    std::printf("%8.0e  %6d\n", w.accuracy, w.order);

  // Its inputs and outputs are the full system's: one can replace the other.
  const SecondOrderModel m = r.second_order();
  std::printf("\nM, D, K: %ld x %ld; modal: %zu blocks of 2 x 2; dense: %d states\n",
              static_cast<long>(m.K.rows()), static_cast<long>(m.K.cols()), r.modal().A.size(),
              r.state_space().order());
  ok &= r.inputs() == r.full().inputs() && r.outputs() == r.full().outputs();
  return ok ? 0 : 1;
}
