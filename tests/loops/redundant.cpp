#include <doctest/doctest.h>

#include <numbers>

#include "assembly.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"

/// Over-constrained chains: motion is determined, internal forces are not.

using namespace loops_test;
using namespace titop;
using titop_test::noted;

namespace {

RigidBody block(double mass, const Vector3d& far) {
  return {.mass = mass,
          .inertia = mass * Vector3d(0.2, 0.3, 0.4).asDiagonal(),
          .PA = far / 3,
          .children = {{"near", far / 2}, {"far", far}}};
}

/// Two bodies welded at two points.
Diagram welded(bool forces) {
  Diagram d{"welded twice"};
  auto A = d.add("A", block(4, {1, 0.5, 0.2})), B = d.add("B", block(3, {0.5, 0.25, 0.1}));
  A.parent.force = -d.input("U", 6);
  mount(B, A.child("near"));
  weld(B.child("far"), A.child("far"));
  d.output("a", 6) = A.parent.accel;
  d.output("b", 6) = B.child("near").accel;
  if (forces) d.output("inner", 6) = B.parent.force;
  return d;
}

by_hand::Matrix6 mass(double m, const Vector3d& A) {
  return mass_at_P(m, (m * Vector3d(0.2, 0.3, 0.4)).asDiagonal(), A);
}

/// A beam, at its tip a body and one on a sprung hinge; the tip and the first body welded again.
Diagram tip(bool again) {
  Diagram d{"tip"};
  const Rotation T = Rotation::about({0, 0.6, 0.8}, d.param("angle", 0.3));
  RigidBody spec = block(3, {0.4, 0.1, 0});
  spec.children.push_back({"root"});
  auto A = d.add("A", FlexibleBody{Tube{2, 0.05, 0.04, 2}.beam()});
  auto B = d.add("B", spec), C = d.add("C", block(2, {0.2, 0.3, 0.5}));
  A.parent.force = -d.input("U", 6);
  mount(B, A.child, T);
  auto h = hinge(d, "h", C, A.child, T, {0, 0, 1});
  h.torque = 40.0 * h.angle + 0.2 * h.rate;
  if (again) weld(A.child, B.child("root"), T.inverse());
  C.child("far").force += d.input("F", 6);
  d.output("a", 6) = C.child("far").accel;
  d.output("b", 6) = B.parent.accel;
  return d;
}

}  // namespace

TEST_CASE("two rigid bodies welded at two points move as one; the closing weld is released") {
  const System system = compile(welded(false));
  CHECK(system.order() == 0);
  const Vector3d near(0.5, 0.25, 0.1), far_B(0.5, 0.25, 0.1);
  const by_hand::Matrix6 M =
      mass(4, Vector3d(1, 0.5, 0.2) / 3) + mass(3, Vector3d(near + far_B / 3));
  MatrixXd exact(12, 6);
  exact.topRows(6) = M.inverse();
  exact.bottomRows(6) = by_hand::tau(-(near + far_B / 2)) * M.inverse();
  CHECK(error_3({system.transfer({0, 1})}, {exact.cast<Complex>()}) <= 1e-13);
  CHECK(noted(system, Note::Kind::info, "chains", {"B.child(\"far\").accel", "6"}));
}

TEST_CASE("a point on which others hang, welded twice: they still bear on it, after an update") {
  const System once = compile(tip(false)), twice = compile(tip(true));
  CHECK(noted(twice, Note::Kind::info, "chains", {"A.child(\"C\").accel", "6"}));
  const std::vector<Complex> s = points({2, 30, 400, 5000});
  for (const double angle : {0.3, -1.1}) {
    const System a = once.update({{"angle", angle}}), b = twice.update({{"angle", angle}});
    CHECK(b.order() == a.order());
    CHECK(error_3(responses(b, s), responses(a, s)) <= 1e-11);
    CHECK(error_3(responses(b.state_space(), s), responses(a, s)) <= 1e-9);
  }
}

TEST_CASE("internal forces: refused by name, or the smallest at the closing joint, and marked") {
  using namespace titop_test;
  CHECK(says(compile_error(welded(true)), Code::kinematic_loop,
             {"inner", "B.parent.force", "B.child(\"far\")", "InternalForces::minimal_norm",
              "loops/redundant.cpp"}));
  const System system = compile(welded(true), {.internal_forces = InternalForces::minimal_norm});
  CHECK(noted(system, Note::Kind::warning, "forces", {"inner", "B.parent.force"}));
  // With nothing at the closing weld the first one carries all: F = -D_B a.
  const MatrixXcd G = system.transfer({0, 1});
  const by_hand::Matrix6 D = mass(3, Vector3d(0.5, 0.25, 0.1) / 3);
  const MatrixXcd at_B = by_hand::tau(-Vector3d(0.5, 0.25, 0.1)) * G.topRows(6);
  CHECK(error_3({G.bottomRows(6)}, {MatrixXcd(-D * at_B)}) <= 1e-12);
}

TEST_CASE("a controller that reads an internal force is refused") {
  using namespace titop_test;
  Diagram e{"controlled"};
  auto A = e.add("A", block(4, {1, 0.5, 0.2})), B = e.add("B", block(3, {0.5, 0.25, 0.1}));
  auto K = e.add("K", Integrator{});
  A.parent.force = -e.input("U", 6);
  mount(B, A.child("near"));
  weld(B.child("far"), A.child("far"));
  K.in = 1.0 * B.parent.force.along({1, 0, 0});
  e.output("k") = K.out;
  CHECK(says(compile_error(e), Code::kinematic_loop,
             {"K.in", "B.child(\"far\")", "InternalForces::minimal_norm"}));
}

TEST_CASE("an internal force in other units, or one that moves another body, is refused too") {
  using namespace titop_test;
  {
    Diagram d{"giganewtons"};
    auto A = d.add("A", block(4, {1, 0.5, 0.2})), B = d.add("B", block(3, {0.5, 0.25, 0.1}));
    A.parent.force = -d.input("U", 6);
    mount(B, A.child("near"));
    weld(B.child("far"), A.child("far"));
    d.output("F", 6) = 1e-9 * B.parent.force;
    CHECK(says(compile_error(d), Code::kinematic_loop,
               {"F", "B.parent.force", "InternalForces::minimal_norm"}));
  }
  Diagram d{"driven"};
  auto A = d.add("A", block(4, {1, 0.5, 0.2})), B = d.add("B", block(3, {0.5, 0.25, 0.1}));
  auto C = d.add("C", block(2, {1, 0, 0}));
  A.parent.force = -d.input("U", 6);
  mount(B, A.child("near"));
  weld(B.child("far"), A.child("far"));
  C.parent.force = Eigen::MatrixXd(0.5 * Eigen::MatrixXd::Identity(6, 6)) * B.parent.force;
  d.output("c", 6) = C.parent.accel;
  CHECK(says(compile_error(d), Code::kinematic_loop,
             {"C", "B.child(\"far\")", "InternalForces::minimal_norm"}));
}

TEST_CASE("a chain that meets only nearly: refused, with the lengths named as a cause") {
  using namespace titop_test;
  for (const double off : {1e-6, 1e-8}) {
    CAPTURE(off);
    Diagram d{"nearly"};
    auto A = d.add("A", block(4, {1, 0.5, 0.2})), B = d.add("B", block(3, {0.5, 0.25 + off, 0.1}));
    A.parent.force = -d.input("U", 6);
    mount(B, A.child("near"));
    weld(B.child("far"), A.child("far"));
    d.output("a", 6) = A.parent.accel;
    CHECK(says(compile_error(d), Code::kinematic_loop, {"B.child(\"far\")"}));
  }
}

TEST_CASE("the total load of two redundant supports of a body is determined") {
  Diagram d{"held twice"};
  auto A = d.add("A", block(4, {1, 0, 0}));
  ground(A);
  ground(A.child("far"));
  A.child("near").force = d.input("F", 6);
  d.output("borne", 3) = A.child("far").reaction.linear() - A.parent.force.linear;
  const MatrixXcd G = compile(d).transfer({0, 1});
  MatrixXcd exact = MatrixXcd::Zero(3, 6);
  exact.leftCols(3) = -MatrixXcd::Identity(3, 3);
  CHECK((G - exact).cwiseAbs().maxCoeff() <= 1e-13);
}

namespace {

constexpr double kLink = 2, kPin = 30;       ///< mass of a link [kg], spring of a pin [N m/rad]
constexpr double kLinkInertia = kLink / 12;  ///< slender, about its middle; taken about every axis

/// Crank, coupler and rocker of length 1, pins 1 apart: a parallelogram. Crank and rocker turn by
/// phi, the coupler only translates; every pin is turned by phi against its spring. The last pin's
/// axis leans by `tilt` out of parallel to the others.
Diagram parallelogram(double tilt) {
  Diagram d{"parallelogram"};
  const auto link = [&] {
    return RigidBody{.mass = kLink,
                     .inertia = kLinkInertia * Matrix3d::Identity(),
                     .PA = {0.5, 0, 0},
                     .children = {{"C", {1, 0, 0}}}};
  };
  auto base = d.add("base", RigidBody{.mass = 1, .children = {{"J1"}, {"J2", {1, 0, 0}}}});
  auto crank = d.add("crank", link()), coupler = d.add("coupler", link()),
       rocker = d.add("rocker", link());
  ground(base);
  const Rotation up = Rotation::about({0, 0, 1}, pi / 2),
                 down = Rotation::about({0, 0, 1}, -pi / 2);
  const Vector3d z{0, 0, 1};
  auto p1 = hinge(d, "p1", crank, base.child("J1"), up, z);
  auto p2 = hinge(d, "p2", coupler, crank.child, down, z);
  auto p3 = hinge(d, "p3", rocker, base.child("J2"), up, z);
  auto p4 = d.add("p4", Hinge{{tilt, 0, 1}});
  mount(p4, rocker.child, down);
  weld(coupler.child, p4.child);
  for (const auto& p : {p1, p2, p3, p4}) p.torque = kPin * p.angle;
  crank.child("C").force += d.input("F", 6);
  d.output("turn") = p4.angle;
  d.output("tip", 6) = coupler.child.accel;
  return d;
}

}  // namespace

TEST_CASE("rigid four-bar, four sprung pins: order 2, three closing equations redundant") {
  const System system = compile(parallelogram(0));
  CHECK(system.order() == 2);
  CHECK(noted(system, Note::Kind::info, "chains", {"3", "6", "x", "y", "z"}));
  const double inertia = 2 * (kLinkInertia + kLink / 4) +
                         kLink;  // crank and rocker about their pins, coupler moves by 1
  const double omega = std::sqrt(4 * kPin / inertia);
  REQUIRE(system.poles().size() == 1);
  CHECK(std::abs(system.poles()[0].omega / omega - 1) <= 1e-14);
  // A force along the coupler on the crank's tip, which points along y of the world: -y of the
  // crank.
  const Complex s{0.1, 3};
  const Complex phi =
      1.0 / (inertia * s * s + 4 * kPin);  // torque of a unit force along y of the crank
  const MatrixXcd G = system.transfer(s);
  CHECK(std::abs(G(0, 1) / -phi - 1.0) <= 1e-12);
  CHECK(std::abs(G(1, 1) / (-s * s * phi) - 1.0) <= 1e-12);
}

TEST_CASE("a pin out of parallel locks a four-bar; by a narrow margin, that is warned of") {
  // pi / 2 typed as 1.5708 is off by 3.7e-6.
  for (const auto& [tilt, order, narrow] : {std::tuple(0.3, 0, false),
                                            {1e-2, 0, false},
                                            {1.5708 - pi / 2, 0, true},
                                            {1e-7, 0, true},
                                            {1e-11, 2, true},
                                            {1e-15, 2, false}}) {
    CAPTURE(tilt);
    const System system = compile(parallelogram(tilt));
    CAPTURE(system.log());
    CHECK(system.order() == order);
    // With the tolerance.
    CHECK(noted(system, Note::Kind::warning, "chains", {"1e-09"}) == narrow);
  }
}

TEST_CASE(
    "both ends of a rigid body on the ground: nothing moves, the second support is released") {
  Diagram d{"held twice"};
  auto A = d.add("A", block(4, {1, 0, 0}));
  ground(A);
  ground(A.child("far"));
  A.child("near").force = d.input("F", 6);
  d.output("a", 6) = A.child("near").accel;
  CHECK(compile(d).transfer({0, 1}).isZero(0));
}

namespace {

/// A chain that does not meet, not an internal force that is read.
void check_gap(const Error& error) {
  INFO(error.what());
  CHECK(titop_test::says(error, Code::kinematic_loop, {}));
  CHECK(!titop_test::has_name(error.what(), "InternalForces::minimal_norm"));
}

}  // namespace

TEST_CASE("a chain that does not meet is refused, whatever the name of a spring beside it") {
  // A table on two legs mounted on the ground, and a spring from it to the ground.
  const auto table = [](const char* spring, double low) {
    Diagram d{"table"};
    auto base = d.add("base", RigidBody{.children = {{"C1"}, {"C2", {0, 1, low}}}});
    auto top = d.add("top", RigidBody{.mass = 3,
                                      .inertia = Eigen::Matrix3d::Identity(),
                                      .children = {{"S", {0, 1, 0}}, {"C", {0.3, 0.2, 0.1}}}});
    auto held = d.add(spring, Bushing{.stiffness = 100 * by_hand::Matrix6::Identity()});
    const RigidBody leg{.mass = 0.1,
                        .inertia = 0.01 * Eigen::Matrix3d::Identity(),
                        .children = {{"end", {0, 0, 1}}}};
    auto one = d.add("leg1", leg), two = d.add("leg2", leg);
    ground(base), mount(held, top.child("C")), ground(held.child);
    joint(d, "foot1", one, base.child("C1"), {}, ball());
    joint(d, "foot2", two, base.child("C2"), {}, ball());
    joint(d, "head1", top, one.child, {}, ball());
    auto head = d.add("head2", Joint{ball()});
    mount(head, two.child), weld(top.child("S"), head.child);
    for (const char* axis : {"rx", "ry", "rz"}) head.axis(axis).force = 0;
    top.child("C").force += d.input("U", 6);
    d.output("a", 6) = top.parent.accel;
    return d;
  };
  for (const char* name : {"a", "foot15", "head15", "leg15", "z"}) {
    CAPTURE(name);
    CHECK(titop_test::compile_error(table(name, 0)).mistakes().empty());
    check_gap(titop_test::compile_error(table(name, 0.1)));
  }
}

TEST_CASE(
    "a pin of a mechanism of a millimetre: a gap counts beside its arms, not beside a metre") {
  const auto pinned = [](double off) {
    constexpr double kArm = 1e-3;
    const auto part = [](const Vector3d& first, const Vector3d& second) {
      return RigidBody{.mass = 1e-3,
                       .inertia = 1e-9 * Eigen::Matrix3d::Identity(),
                       .children = {{"C1", first}, {"C2", second}}};
    };
    Diagram d{"small"};
    auto A = d.add("A", part({kArm, 0, 0}, {2 * kArm, off, 0}));
    auto B = d.add("B", part({kArm, 0, 0}, {0, kArm, 0}));
    A.parent.force = -d.input("U", 6);
    mount(B, A.child("C1"));
    const Rotation T = Rotation().named("A", "B");
    B.child("C1").accel.linear = T.inverse() * A.child("C2").accel.linear;
    release(B.child("C1"));
    A.child("C2").force += -(T * B.child("C1").reaction);
    d.output("a", 6) = A.parent.accel;
    return d;
  };
  CHECK(titop_test::compile_error(pinned(0)).mistakes().empty());
  check_gap(titop_test::compile_error(pinned(1e-6)));
}
