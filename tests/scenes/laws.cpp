#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "by_hand.hpp"

/// Laws of any structure: rigid mass at rest, reciprocity, independence of frames and of the root
/// of the tree, signs of a joint.

using namespace scenes_test;
using namespace titop;

namespace {

const Tube kTube{1.4, 0.04, 0.03, 3};
const Vector3d kPA(0.1, -0.2, 0.05), kC(0.4, 0.3, -0.2), kAxis(1, 3, -2);
const Matrix3d kInertia = (Matrix3d() << 5, 0.4, -0.3, 0.4, 6, 0.2, -0.3, 0.2, 7).finished();
constexpr double kMass = 40, kAngle = 1.1;

RigidBody hub() { return {.mass = kMass, .inertia = kInertia, .PA = kPA, .children = {{"C", kC}}}; }

/// Hub and boom, loaded and seen at the hub's P (in its frame) and the boom's tip (in the boom's).
Diagram hub_and_boom(const FlexibleBody& boom, const Rotation& T_ba) {
  Diagram d{"hub and boom"};
  auto W = d.input("W", 6), F = d.input("F", 6);
  auto h = d.add("hub", hub());
  auto b = d.add("boom", boom);
  h.parent.force = -W;
  mount(b, h.child, T_ba);
  b.child.force = F;
  d.output("P", 6) = h.parent.accel;
  d.output("tip", 6) = b.child.accel;
  return d;
}

const auto kPoints = points({20, 150, 600, 2500, 12000});

}  // namespace

TEST_CASE("at rest a free structure is its rigid mass") {
  const System system = compile(hub_and_boom(kTube.beam(), Rotation::about(kAxis, kAngle)));
  const by_hand::FreeBeam fe = by_hand::free_beam(kTube.numbers());
  const MatrixXd Y =
      by_hand::rigid_motion(kTube.numbers()) *
      by_hand::dual(Eigen::AngleAxisd(kAngle, kAxis.normalized()).matrix().transpose()) *
      by_hand::tau(-kC);
  by_hand::Matrix6 own = by_hand::Matrix6::Zero();
  own.topLeftCorner<3, 3>().diagonal().setConstant(kMass);
  own.bottomRightCorner<3, 3>() = kInertia;
  const MatrixXd M =
      by_hand::tau(-kPA).transpose() * own * by_hand::tau(-kPA) + Y.transpose() * fe.M * Y;
  MatrixXd both(6, 12);
  both << MatrixXd::Identity(6, 6), Y.bottomRows(6).transpose();
  const MatrixXcd exact = (both.transpose() * M.inverse() * both).cast<Complex>();
  CHECK(error_3({system.static_gain().cast<Complex>()}, {exact}) <= 1e-12);
}

TEST_CASE("reciprocity: collocated wrenches and accelerations give a symmetric transfer") {
  const System system = compile(hub_and_boom(kTube.beam(), Rotation::about(kAxis, kAngle)));
  std::vector<MatrixXcd> G = responses(system, kPoints), transposed;
  for (const MatrixXcd& g : G) transposed.push_back(g.transpose());
  CHECK(error_3(transposed, G) <= 1e-12);
}

TEST_CASE("a body described in a turned frame is the same body") {
  const ModalData straight = modal_data(kTube.beam());
  const Matrix3d T =
      Eigen::AngleAxisd(0.7, Vector3d(2, -1, 1).normalized()).matrix();  // to the new
  const by_hand::Matrix6 TT = by_hand::dual(T);
  ModalData turned = straight;
  turned.L_P = straight.L_P * TT.transpose();
  turned.D_P = TT * straight.D_P * TT.transpose();
  turned.children[0].PC = T * straight.children[0].PC;
  turned.children[0].Phi_C = TT * straight.children[0].Phi_C;
  const Rotation T_ba = Rotation::about(kAxis, kAngle);
  const auto exact = responses(compile(hub_and_boom(straight, T_ba)), kPoints);
  auto G = responses(compile(hub_and_boom(turned, T_ba * Rotation::matrix(T).inverse())), kPoints);
  for (MatrixXcd& g : G) {  // its tip speaks the new frame
    g.bottomRows(6) = (TT.transpose().cast<Complex>() * g.bottomRows(6)).eval();
    g.rightCols(6) = (g.rightCols(6) * TT.cast<Complex>()).eval();
  }
  CHECK(error_3(G, exact) <= 1e-12);
}

TEST_CASE("the tree may be rooted anywhere") {
  // The same two bodies, the hub hanging on the boom: P and C of both change places.
  const FlexibleBody reversed = fe::modal_data(beam_mesh(kTube.beam()), "C", {"P"});
  const RigidBody hub_at_C{
      .mass = kMass, .inertia = kInertia, .PA = kPA - kC, .children = {{"P", -kC}}};
  const Rotation T_ba = Rotation::about(kAxis, kAngle);
  Diagram d{"rooted at the tip"};
  auto W = d.input("W", 6), F = d.input("F", 6);
  auto b = d.add("boom", reversed);
  auto h = d.add("hub", hub_at_C);
  mount(h, b.child, T_ba.inverse());
  b.parent.force = -F;
  h.child.force = W;
  d.output("P", 6) = h.child.accel;
  d.output("tip", 6) = b.parent.accel;
  const auto exact = responses(compile(hub_and_boom(kTube.beam(), T_ba)), kPoints);
  CHECK(error_3(responses(compile(d), kPoints), exact) <= 1e-11);
}

TEST_CASE("signs of a joint: the spring pulls back, the motor pushes on") {
  for (const double k : {50.0, -50.0}) {
    Diagram d{"joint"};
    auto u = d.input("u");
    auto h = d.add("hub", hub());
    auto b = d.add("boom", FlexibleBody{kTube.beam()});
    ground(h);
    auto j = hinge(d, "joint", b, h.child, Rotation::about(kAxis, kAngle), {0, 2, 0});
    j.torque = k * j.angle + 4.0 * j.rate - u;
    d.output("theta") = j.angle;
    d.output("thetadd") = j.accel;
    const System system = compile(d);
    double rightmost = -1e300;
    for (const Pole& p : system.poles()) rightmost = std::max(rightmost, p.s.real());
    if (k < 0) {
      CHECK(rightmost > 1);  // the spring's sign turned: it topples
      continue;
    }
    CHECK(rightmost <= 1e-7);  // modes that the joint does not damp stay on the axis
    CHECK(std::abs(system.static_gain()(0, 0) - 1 / k) <= 1e-9 / k);  // tau turns it by +tau / k
    CHECK(system.state_space().D(1, 0) > 0);  // and at once pushes it that way
  }
}

TEST_CASE(
    "a hinge that is held is a mount, a hinge that is driven takes its torque from the boom") {
  const FlexibleBody boom = kTube.beam();
  const Rotation T_ba = Rotation::about(kAxis, kAngle);
  Diagram d{"held"};
  auto W = d.input("W", 6), F = d.input("F", 6);
  auto h = d.add("hub", hub());
  auto b = d.add("boom", boom);
  h.parent.force = -W;
  auto j = hinge(d, "joint", b, h.child, T_ba, {1, 1, 0});
  j.accel = 0;
  b.child.force = F;
  d.output("P", 6) = h.parent.accel;
  d.output("tip", 6) = b.child.accel;
  const System held = compile(d), mounted = compile(hub_and_boom(boom, T_ba));
  CHECK(error_3(responses(held, kPoints), responses(mounted, kPoints)) <= 1e-12);
  CHECK(held.state_space().order() == mounted.state_space().order());
}
