#include <doctest/doctest.h>

#include "held.hpp"
#include "scenes.hpp"
#include "support/mistakes.hpp"

/// Loops of more states than are balanced at once, and the limits of balanced states.
using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

TEST_CASE("flexible bodies in a loop: they lose modes first where the states are too many") {
  // A hub with two beams, turned by a law that reads its attitude; the same, balanced whole.
  const FlexibleBody beam = slim_beam(6, 0.005);
  Diagram d{"turned"};
  auto W = d.input("W");
  auto hub = d.add("hub", RigidBody{.mass = 40,
                                    .inertia = Vector3d(9, 11, 13).asDiagonal(),
                                    .children = {{"C1", {0.3, 0, 0}}, {"C2", {-0.3, 0.05, 0}}}});
  auto left = d.add("left", beam), right = d.add("right", beam);
  auto law = d.add(
      "law", Lti{.A = one(-60), .B = one(1), .C = one((40 - 30 * 60.0) * 60), .D = one(30 * 60)});
  MatrixXd about = MatrixXd::Zero(6, 1);
  about(5) = 1;
  law.in = about.transpose() * hub.parent.position;
  hub.parent.force = about * law.out - about * W;
  mount(left, hub.child("C1"), Rotation{});
  mount(right, hub.child("C2"), Rotation::about({0, 0, 1}, 2.9));
  d.output("angle") = about.transpose() * hub.parent.position;
  d.output("tip", 3) = left.child("C").accel.linear;
  // The free structure by hand, and the loop closed around it.
  Tree tree(true);
  const int root = tree.add(RigidBody{.mass = 40,
                                      .inertia = Vector3d(9, 11, 13).asDiagonal(),
                                      .children = {{"C1", {0.3, 0, 0}}, {"C2", {-0.3, 0.05, 0}}}});
  const int boom = tree.add(beam.data(), root, 0);
  tree.add(beam.data(), root, 1, Rotation::about({0, 0, 1}, 2.9).nominal());
  MatrixXl read(4, tree.motion(root).cols());
  read << tree.motion(root).row(5), tree.motion(boom, 0).topRows(3);
  const Truth open = truth_of(tree.structure(tree.motion(root).row(5), read), true, {0, 2, 2, 2});
  const auto closed = [&](Complex s) {
    const MatrixXcd H = open.transfer(s);
    return MatrixXcd(H / (1.0 + (40.0 + 30.0 * s) * 60.0 / (s + 60.0) * H(0, 0)));
  };
  titop::Scene scene{.band_hz = {0, 40}, .accuracy = 1e-2};
  const ReducedSystem whole = compile(d, scene);
  scene.balance_up_to = 100;
  const ReducedSystem r = compile(d, scene);
  CHECK(whole.full().order() > 140);
  CHECK(step(r, "bodies").error <= 3e-3);
  CHECK(step(r, "kept").before <= 100);
  CHECK(r.bound().worst <= 1e-2);
  CHECK(r.order() <= 1.3 * whole.order());
  for (const ReducedSystem* system : {&whole, &r}) {
    CHECK(beside(*system, scene, with_poles(*system, closed)).bound <= 1);
    CHECK(rightmost(system->state_space()) < 0);
  }
  scene.balance_up_to = 4;
  CHECK(says(error_of([&] { compile(d, scene); }), Code::bad_value,
             {"balance_up_to = 4", "law.x1", "left"}));
}

TEST_CASE("limits of balanced states are refused with the accuracy reached, large scenes too") {
  const Held held;
  CHECK(says(error_of([&] {
               compile(held.diagram(), titop::Scene{.band_hz = {0, 8}, .accuracy = 2e-12});
             }),
             Code::bad_value, {"2.0e-12", "z1.parent.position"}));
  CHECK(says(error_of([&] {
               compile(held.diagram(), titop::Scene{.band_hz = {0, 8}, .balance_up_to = 0});
             }),
             Code::bad_value, {"0", "Scene::balance_up_to"}));
  CHECK(says(error_of([&] {
               compile(held.diagram(),
                       titop::Scene{
                           .band_hz = {0, 8}, .bound = BoundKind::theorem, .balance_up_to = 10});
             }),
             Code::bad_value, {"theorem", "balance_up_to"}));
}

TEST_CASE(
    "a pole that cannot be told from one on the axis is refused by the state that moves in it") {
  // Eigenvalues 1e-8 and -5e-7 with eigenvectors as near to each other, rotated by 45 degrees to
  // hide the pattern: the transformation between the parts is 1 / 5e-7.
  const double e = 5e-7, up = 1e-8;
  MatrixXd A(2, 2);
  A << (up - 1 - e) / 2, (up + 1 + e) / 2, (up - 1 + e) / 2, (up + 1 - e) / 2;
  MatrixXd B(2, 1), C(1, 2);
  B << 1, 2;
  C << 3, 1;
  Diagram d{"creeping"};
  auto u = d.input("u");
  auto law = d.add("law", Lti{.A = A, .B = B, .C = C});
  law.in = u;
  d.output("y") = law.out;
  const Error error = error_of([&] { compile(d, titop::Scene{.band_hz = {0.1, 1}}); });
  CHECK((says(error, Code::singular, {"law.x1", "compile(diagram)"}) ||
         says(error, Code::singular, {"law.x2", "compile(diagram)"})));
}
