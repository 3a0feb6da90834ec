#include <doctest/doctest.h>

#include "against.hpp"
#include "scenes.hpp"
#include "support/mistakes.hpp"

/// If the whole is too large for one eigenproblem, bodies lose modes first. Here the limit is
/// small instead.
using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;

namespace {

titop::Scene limited(titop::Scene scene, int whole_up_to) {
  scene.whole_up_to = whole_up_to;
  return scene;
}

const ReductionStep& step(const ReducedSystem& r, const std::string& name) {
  for (const ReductionStep& s : r.steps())
    if (s.name == name) return s;
  FAIL("no step " << name);
  return r.steps().front();
}

}  // namespace

TEST_CASE("smaller bodies: the bound holds against the full system, the order hardly grows") {
  for (const double xi : {0.0, 0.005})
    for (const double accuracy : {1e-2, 1e-5}) {
      CAPTURE(xi);
      CAPTURE(accuracy);
      const Diagram d = frame(slim_beam(8, xi));
      const titop::Scene scene{.band_hz = {0, 60}, .accuracy = accuracy};
      const ReducedSystem whole = compile(d, scene), r = compile(d, limited(scene, 120));
      CHECK(r.full().order() == 2 * 3 * 48);
      CHECK(step(r, "bodies").before == 144);
      CHECK(step(r, "bodies").after <= 120);
      CHECK(step(r, "bodies").error <= 0.3 * accuracy);
      CHECK(step(r, "bodies").error > 0);
      check_beside(r, scene, frame_by_hand(slim_beam(8, xi)));
      CHECK(r.order() <= 1.3 * whole.order());
      for (const Pole& p : poles(r.state_space()))
        CHECK((xi == 0 ? p.s.real() == 0 : p.s.real() < 0));
      CHECK(r.inputs() == whole.inputs());
      CHECK(r.outputs() == whole.outputs());
    }
}

TEST_CASE("smaller bodies: a body that carries 50 times its mass keeps its static answer") {
  const FlexibleBody beam = slim_beam(8);
  const double m = 50 * beam.data().D_P(0, 0);
  Diagram d{"heavy"};
  auto U = d.input("U", 6);
  auto b = d.add("beam", beam);
  auto tip = d.add("tip", RigidBody{.mass = m, .inertia = Matrix3d::Identity() * 0.03 * m});
  b.parent.accel = 0;
  mount(tip, b.child("C"), Rotation{});
  b.child("C").force += U;
  d.output("a", 6) = tip.parent.accel;
  const titop::Scene scene{.band_hz = {0, 60}, .accuracy = 1e-4, .whole_up_to = 40};
  const ReducedSystem r = compile(d, scene);
  CHECK(step(r, "bodies").after <= 40);
  Tree tree(false);
  const int by_hand = tree.add(beam.data());
  tree.add(RigidBody{.mass = m, .inertia = Matrix3d::Identity() * 0.03 * m}, by_hand);
  const MatrixXl end = tree.motion(by_hand, 0);
  check_beside(r, scene, truth_of(tree.structure(end, end)));
}

TEST_CASE("far below its first mode a free body is rigid: it has no coordinates") {
  Diagram d{"free"};
  auto U = d.input("U", 6);
  auto b1 = d.add("b1", slim_beam(6)), b2 = d.add("b2", slim_beam(6));
  b1.parent.force = -U;
  mount(b2, b1.child("C"), Rotation::about({0, 1, 1}, 0.8));
  d.output("a", 6) = b1.parent.accel;
  const titop::Scene scene{.band_hz = {0, 1e-6}, .accuracy = 1e-3, .whole_up_to = 10};
  const ReducedSystem r = compile(d, scene);
  CHECK(step(r, "bodies").before == 72);
  CHECK(step(r, "bodies").after == 0);
  CHECK(step(r, "bodies").text.find("rigid") != std::string::npos);
  CHECK(r.order() == 0);
  Tree tree(true);
  const int root = tree.add(slim_beam(6).data());
  tree.add(slim_beam(6).data(), root, 0, Rotation::about({0, 1, 1}, 0.8).nominal());
  check_beside(r, scene, truth_of(tree.structure(tree.motion(root), tree.motion(root)), true));
}

TEST_CASE("smaller bodies: positions, rates and static gain are kept") {
  Diagram d{"boom"};
  auto U = d.input("U", 6);
  auto b1 = d.add("b1", slim_beam(6)), b2 = d.add("b2", slim_beam(6));
  b1.parent.accel = 0;
  mount(b2, b1.child("C"), Rotation::about({1, 2, 3}, 0.7));
  b2.child("C").force = U;
  d.output("x", 6) = b2.child("C").position;
  d.output("v", 6) = b1.child("C").rate;
  const titop::Scene scene{.band_hz = {0, 40}, .accuracy = 1e-4, .whole_up_to = 60};
  const ReducedSystem r = compile(d, scene);
  CHECK(step(r, "bodies").after <= 60);
  Tree tree(false);
  const int root = tree.add(slim_beam(6).data());
  const int second =
      tree.add(slim_beam(6).data(), root, 0, Rotation::about({1, 2, 3}, 0.7).nominal());
  MatrixXl read(12, tree.motion(root).cols());
  read << tree.motion(second, 0), tree.motion(root, 0);
  const Truth truth = truth_of(tree.structure(tree.motion(second, 0), read), false,
                               {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1});
  check_beside(r, scene, truth);
  const titop::Scene still{.outputs = {"x"}, .accuracy = 1e-6, .whole_up_to = 30};
  const ReducedSystem gain = compile(d, still);
  CHECK(gain.order() == 0);
  const MatrixXd exact = truth.transfer(0).real().topRows(6);
  CHECK((gain.state_space().D - exact).norm() <= 1e-6 * exact.norm());
}

TEST_CASE("smaller bodies that are twins stay twins") {
  const FlexibleBody beam = slim_beam(6);
  Diagram d{"twins"};
  auto U = d.input("U", 6);
  auto hub = d.add("hub", RigidBody{.mass = 20,
                                    .inertia = Vector3d(1, 2, 3).asDiagonal(),
                                    .children = {{"C1", {0.3, 0, 0}}, {"C2", {-0.3, 0, 0}}}});
  auto left = d.add("left", beam), right = d.add("right", beam);
  hub.parent.force = -U;
  const Matrix3d turn = Vector3d(-1, -1, 1).asDiagonal();
  mount(left, hub.child("C1"), Rotation{});
  mount(right, hub.child("C2"), Rotation::matrix(turn));
  d.output("a", 6) = hub.parent.accel;
  const titop::Scene scene{.inputs = {"U(3)"},
                           .outputs = {"a(3)"},
                           .band_hz = {0, 60},
                           .accuracy = 1e-4,
                           .whole_up_to = 60};
  const ReducedSystem r = compile(d, scene);
  CHECK(step(r, "bodies").after < 60);
  CHECK(2 * step(r, "symmetry").after == step(r, "symmetry").before);
  Tree tree(true);
  const int root = tree.add(RigidBody{.mass = 20,
                                      .inertia = Vector3d(1, 2, 3).asDiagonal(),
                                      .children = {{"C1", {0.3, 0, 0}}, {"C2", {-0.3, 0, 0}}}});
  tree.add(beam.data(), root, 0);
  tree.add(beam.data(), root, 1, turn);
  const MatrixXl up = tree.motion(root).row(2);
  check_beside(r, scene, truth_of(tree.structure(up, up), true));
}

TEST_CASE("too large scenes are refused with the vectors that bodies need, theorems too") {
  const Diagram d = frame(slim_beam(6));
  titop::Scene scene{.band_hz = {0, 60}, .accuracy = 1e-2, .whole_up_to = 20};
  const Error error = error_of([&] { compile(d, scene); });
  CHECK(says(error, Code::bad_value, {"Scene::whole_up_to = 20", "b1", "2", "36"}));
  scene.bound = BoundKind::theorem;
  CHECK(says(error_of([&] { compile(d, scene); }), Code::bad_value, {"theorem", "whole_up_to"}));
}
