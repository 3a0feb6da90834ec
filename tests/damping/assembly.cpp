// A boom with a mass at its tip as one body, whose assembled modes have the damping ratios of a
// test report: against M, D, K by hand, clamped at the root and free.
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "scenes/isolated_wheel.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;
using namespace scenes_test;

namespace {

const Tube kTube{2.3, 0.06, 0.055, 2};
const Vector3d kTurn(1, 2, -1), kTip(0.1, -0.05, 0.2);  // of the mounting; the child on the tip [m]
constexpr double kAngle = 0.7, kMass = 12;              // [rad], [kg]
const Vector3d kInertia(0.3, 0.4, 0.5);                 // [kg m^2]
const ModalDamping kReport{{1.0, 0.003}, {20.0, 0.01}, {400.0, 0.002}};

/// The table of `kReport`, by hand.
double reported(double omega) {
  const double hertz = omega / (2 * pi);
  if (hertz < 1) return 0.003;
  if (hertz < 20) return 0.003 + 0.007 * (hertz - 1) / 19;
  return hertz < 400 ? 0.01 - 0.008 * (hertz - 20) / 380 : 0.002;
}

Diagram boom_with_tip() {
  Diagram part{"boom with tip"};
  Beam beam = kTube.beam();
  beam.modes.xi = {0.02};  // of the clamped boom: replaced
  auto boom = part.add("boom", FlexibleBody{beam});
  auto tip = part.add(
      "tip",
      RigidBody{.mass = kMass, .inertia = kInertia.asDiagonal(), .children = {{"C1", kTip}}});
  mount(tip, boom.child("C"), Rotation::about(kTurn, kAngle));
  return part;
}

FlexibleBody assembled(RootBoundary boundary) {
  return damping_of_assembly(boom_with_tip(), "boom.parent", {{"tip", "tip.C1"}}, kReport,
                             boundary);
}

/// M Phi diag(2 xi w) Phi' M of the modes with stiffness.
MatrixXd modal_damping(const MatrixXd& M, const MatrixXd& K, Index rigid) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> e(K, M);
  MatrixXd D = MatrixXd::Zero(M.rows(), M.cols());
  for (Index k = rigid; k < M.rows(); ++k) {
    const double w = std::sqrt(e.eigenvalues()(k));
    const VectorXd f = M * e.eigenvectors().col(k);
    D += 2 * reported(w) * w * f * f.transpose();
  }
  return D;
}

/// Coordinates: the root, then displacements of the free nodes relative to it. Outputs:
/// accelerations of the root and of the child on the tip, in the root's frame; inputs: wrenches
/// there.
by_hand::Structure by_elements() {
  const by_hand::Beam beam = kTube.numbers();
  const by_hand::FreeBeam fe = by_hand::free_beam(beam);
  const Index own = 6 * beam.elements, n = 6 + own;
  by_hand::Structure a = by_hand::empty(n, 12, 12);
  MatrixXd Y = MatrixXd::Zero(n, n);
  Y.leftCols(6) = by_hand::rigid_motion(beam);
  Y.bottomRightCorner(own, own).setIdentity();
  const Matrix3d T = Eigen::AngleAxisd(kAngle, kTurn.normalized()).matrix();
  MatrixXd M = fe.M;
  M.bottomRightCorner(3, 3) += T * kInertia.asDiagonal() * T.transpose();
  M.block(n - 6, n - 6, 3, 3).diagonal().array() += kMass;
  a.M = Y.transpose() * M * Y;
  a.K.bottomRightCorner(own, own) = fe.K.bottomRightCorner(own, own);
  a.C.topLeftCorner(6, 6).setIdentity();
  a.C.bottomRows(6) = by_hand::tau(-(T * kTip)) * Y.bottomRows(6);
  a.B = a.C.transpose();
  return a;
}

/// The body alone, free: wrenches at the root and at the child, accelerations of both.
System on_free_root(const FlexibleBody& body) {
  Diagram d{"free"};
  auto wing = d.add("wing", body);
  wing.parent.force = -d.input("P", 6);
  wing.child("tip").force = d.input("C", 6);
  d.output("P", 6) = wing.parent.accel;
  d.output("C", 6) = wing.child("tip").accel;
  return compile(d);
}

System on_clamped_root(const FlexibleBody& body) {
  Diagram d{"clamped"};
  auto wing = d.add("wing", body);
  wing.parent.accel = 0;
  wing.child("tip").force = d.input("C", 6);
  d.output("C", 6) = wing.child("tip").accel;
  return compile(d);
}

const std::vector<Complex> kPoints = points({3, 20, 90, 400, 2000, 20000});

double worst_against(const System& system, const by_hand::Structure& a) {
  std::vector<MatrixXcd> exact;
  for (const Complex s : kPoints) exact.push_back(by_hand::accel_transfer(a, s));
  return error_3(responses(system, kPoints), exact);
}

/// Largest |damping - reported| of oscillating poles; their count must be this.
double worst_damping(const System& system, int count) {
  double worst = 0;
  for (const Pole& p : system.poles()) {
    if (!p.pair) continue;
    worst = std::max(worst, std::abs(p.damping - reported(p.omega)));
    --count;
  }
  return count == 0 ? worst : HUGE_VAL;
}

}  // namespace

/// {{0.003}} is one damping ratio, and no row of a frequency without a ratio.
static_assert(!std::is_constructible_v<DampingPoint, double>);

TEST_CASE("a boom of one mode with 12 kg on its tip: the assembly has the prescribed damping") {
  // Bending along y: the tip moves by phi per modal coordinate, so that the modal mass is 1 + 12
  // phi^2 = 36 and xi = 0.3 % of the clamped boom is 0.05 % in the assembly.
  const double omega = 10.8, phi = std::sqrt(35.0 / 12), xi = 0.003;
  ModalData data;
  data.omega = VectorXd::Constant(1, omega);
  data.xi = VectorXd::Constant(1, xi);
  data.L_P = Eigen::RowVectorXd::Unit(6, 1);
  data.D_P = Vector6(3, 3, 3, 0.1, 4, 4).asDiagonal();
  data.children = {{"C", {0, 0, 0}, Vector6::Unit(1) * phi}};
  Diagram part{"boom with 12 kg"};
  auto boom = part.add("boom", FlexibleBody{data});
  auto tip = part.add("tip", RigidBody{.mass = 12, .children = {{"C"}}});
  mount(tip, boom.child("C"));

  const auto on_bench = [](Diagram& d, const BodyHandle& root, const BodyHandle& end) {
    root.parent.accel = 0;
    end.child("C").force = d.input("F", 6);
    d.output("y", 6) = end.child("C").accel;
    return compile(d).poles();
  };
  Diagram e{"as blocks"};
  auto boom2 = e.add("boom", FlexibleBody{data});
  auto tip2 = e.add("tip", RigidBody{.mass = 12, .children = {{"C"}}});
  mount(tip2, boom2.child("C"));
  const std::vector<Pole> before = on_bench(e, boom2, tip2);
  REQUIRE(before.size() == 1);
  CHECK(std::abs(before[0].omega - 1.8) <= 1e-12);
  CHECK(std::abs(before[0].damping - 0.0005) <= 1e-12);

  const FlexibleBody body = damping_of_assembly(part, "boom.parent", {{"C", "tip.C"}}, xi);
  Diagram f{"as one body"};
  auto wing = f.add("wing", body);
  const std::vector<Pole> after = on_bench(f, wing, wing);
  REQUIRE(after.size() == 1);
  CHECK(std::abs(after[0].omega - 1.8) <= 1e-12);
  CHECK(std::abs(after[0].damping - xi) <= 1e-12);
}

TEST_CASE("modes clamped at the root: each has its damping ratio of the table") {
  const FlexibleBody body = assembled(RootBoundary::clamped);
  const System system = on_clamped_root(body);
  CHECK(worst_damping(system, 12) <= 1e-10);
  by_hand::Structure a = by_elements();
  const Index own = a.M.rows() - 6;
  a.D.bottomRightCorner(own, own) =
      modal_damping(a.M.bottomRightCorner(own, own), a.K.bottomRightCorner(own, own), 0);
  CHECK(worst_against(on_free_root(body), a) <= 1e-9);
}

TEST_CASE("modes of the free part: each has its damping ratio of the table") {
  const FlexibleBody body = assembled(RootBoundary::free);
  const System system = on_free_root(body);
  CHECK(worst_damping(system, 12) <= 1e-10);
  by_hand::Structure a = by_elements();
  a.D = modal_damping(a.M, a.K, 6);
  CHECK(worst_against(system, a) <= 1e-9);
}

TEST_CASE("a body with a damping matrix: from a file, in port-Hamiltonian form, passive") {
  const FlexibleBody body = assembled(RootBoundary::free);
  Diagram d{"free"};
  auto wing = d.add("wing", body);
  wing.parent.force = -d.input("U", 6);
  d.output("P", 6) = wing.parent.accel;
  const System system = compile(d), read = compile(parse_diagram(diagram_json(d)));
  CHECK(read.transfer({1, 30}) == system.transfer({1, 30}));
  CHECK(certify(system).holds());
  const PortHamiltonian h = port_hamiltonian(body);
  CHECK(h.R.bottomRightCorner(12, 12) == body.damping());
}

TEST_CASE("a parallelogram of four hinges on one spring: one mode, by hand") {
  const double side = 0.8, base = 1.5, link = 2, coupler = 3, inertia = 0.4, spring = 70;
  const Vector3d z(0, 0, 1);
  const auto turn = [&](double angle) { return Rotation::about(z, angle); };
  const auto bar = [&](double length, double mass) {
    return RigidBody{.mass = mass,
                     .inertia = inertia * Matrix3d::Identity(),
                     .PA = {length / 2, 0, 0},
                     .children = {{"C", {length, 0, 0}}}};
  };
  Diagram part{"parallelogram"};
  auto root = part.add("root", RigidBody{.mass = 5,
                                         .inertia = Matrix3d::Identity(),
                                         .children = {{"J1"}, {"J2", {base, 0, 0}}}});
  auto crank = part.add("crank", bar(side, link)), rocker = part.add("rocker", bar(side, link)),
       top = part.add("top", bar(base, coupler));
  auto shaft = hinge(part, "shaft", crank, root.child("J1"), turn(pi / 2), z);
  shaft.torque = spring * shaft.angle;
  hinge(part, "p2", top, crank.child, turn(-pi / 2), z).torque = 0;
  hinge(part, "p3", rocker, root.child("J2"), turn(pi / 2), z).torque = 0;
  auto p4 = part.add("p4", Hinge{z});
  p4.torque = 0;
  mount(p4, rocker.child, turn(-pi / 2));
  weld(top.child, p4.child);
  const ModalData data = damping_of_assembly(part, "root.parent", {{"C", "crank.C"}}, 0.004).data();
  // About the pivots: both links turn, the coupler moves by `side` without turning.
  const double I = 2 * (inertia + link * side * side / 4) + coupler * side * side;
  REQUIRE(data.omega.size() == 1);
  CHECK(std::abs(data.omega(0) - std::sqrt(spring / I)) <= 1e-9 * data.omega(0));
  CHECK(data.xi(0) == 0.004);
  CHECK((data.children[0].PC - Vector3d(0, side, 0)).norm() <= 1e-9);
  // The crank points along y: its tip moves by -side along x per radian.
  CHECK(std::abs(std::abs(data.children[0].Phi_C(0, 0)) - side / std::sqrt(I)) <= 1e-9);
  CHECK(std::abs(std::abs(data.L_P(0, 0)) -
                 (2 * link * side / 2 + coupler * side) / std::sqrt(I)) <= 1e-9 * coupler);
  CHECK(std::abs(data.D_P(0, 0) - (5 + 2 * link + coupler)) <= 1e-9);
}

namespace {

/// By hand, in the root's frame at the angle t about (1, 2, 3): a panel on a hub, by one joint on a
/// spring. Its one mode moves a point r of the panel, from the joint, by axis x r (hinge) or axis
/// (slider) per unit.
struct OneMode {
  double omega;
  Vector6 Phi, L;
};

constexpr double kPanel = 2, kSpring = 100;  // [kg], [N m or N/m]
const Vector3d kAxis(0, 1, 0), kCentre(0.5, 0.2, 0.1), kEnd(1, 0.3, 0.2), kSite(1, 0, 0);
const Vector3d kOwn(0.2, 0.2, 0.3);  // about the centre of mass [kg m^2]

OneMode by_hand_at(double t, bool hinged) {
  const Matrix3d T = Eigen::AngleAxisd(t, Vector3d(1, 2, 3).normalized()).matrix();
  const Vector3d a = T * kAxis, turn = hinged ? a : Vector3d::Zero();
  const auto motion = [&](const Vector3d& r) { return hinged ? a.cross(T * r).eval() : a; };
  const Vector3d p = kPanel * motion(kCentre);  // momentum per unit of the rate
  const Vector3d h = (kSite + T * kCentre).cross(p) + T * kOwn.asDiagonal() * T.transpose() * turn;
  const double m = kPanel * motion(kCentre).squaredNorm() +
                   turn.dot(T * kOwn.asDiagonal() * T.transpose() * turn);
  OneMode mode{std::sqrt(kSpring / m), {}, {}};
  mode.Phi << motion(kEnd), turn;
  mode.L << p, h;
  mode.Phi /= std::sqrt(m), mode.L /= std::sqrt(m);
  return mode;
}

FlexibleBody panel_at(double t, bool hinged) {
  Diagram part{"part"};
  auto hub = part.add(
      "hub", RigidBody{.mass = 10, .inertia = Matrix3d::Identity(), .children = {{"c", kSite}}});
  auto panel = part.add("panel", RigidBody{.mass = kPanel,
                                           .inertia = kOwn.asDiagonal(),
                                           .PA = kCentre,
                                           .children = {{"tip", kEnd}}});
  const Rotation turn = Rotation::about({1, 2, 3}, t);
  if (hinged) {
    auto joint = hinge(part, "h", panel, hub.child, turn, kAxis);
    joint.torque = kSpring * joint.angle;
  } else {
    auto joint = slide(part, "h", panel, hub.child, turn, kAxis);
    joint.force = kSpring * joint.travel;
  }
  return damping_of_assembly(part, "hub.parent", {{"tip", "panel.tip"}}, 0.003);
}

}  // namespace

TEST_CASE("two bodies on a joint with a spring, at 200 angles: one mode, by hand") {
  for (const bool hinged : {true, false})
    for (int k = 0; k < 200; ++k) {
      CAPTURE(hinged);
      CAPTURE(k);
      const double t = 0.005 * k;
      const OneMode exact = by_hand_at(t, hinged);
      const ModalData data = panel_at(t, hinged).data();
      REQUIRE(data.omega.size() == 1);
      CHECK(std::abs(data.omega(0) - exact.omega) <= 1e-12 * exact.omega);
      CHECK(data.xi(0) == 0.003);
      const MatrixXd& Phi = data.children[0].Phi_C;
      const double sign = Phi.col(0).dot(exact.Phi) > 0 ? 1 : -1;
      CHECK((sign * Phi - exact.Phi).norm() <= 1e-12);
      CHECK((sign * data.L_P.transpose() - exact.L).norm() <= 1e-12 * exact.L.norm());
    }
}

TEST_CASE("a wheel on bushings whose axes are coupled: the damping of the free modes") {
  for (const bool two : {false, true})
    for (const bool damped : {false, true}) {
      CAPTURE(two);
      CAPTURE(damped);
      const IsolatedWheel wheel{.two = two, .damped = damped};
      Diagram part{"isolated wheel"};
      wheel.add(part);
      const FlexibleBody body = damping_of_assembly(part, "hub.parent", {{"tip", "wheel.rim"}},
                                                    kReport, RootBoundary::free);
      by_hand::Structure a = wheel.by_hand();
      a.D = modal_damping(a.M, a.K, 6);
      // Children of the part have the frame of its root.
      const MatrixXd turn = by_hand::dual(wheel.T());
      a.C.bottomRows(6) = turn * a.C.bottomRows(6);
      a.B = a.C.transpose();
      CHECK(worst_against(on_free_root(body), a) <= 1e-9);
    }
}
