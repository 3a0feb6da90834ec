#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Forces added at a point that moves with another act through its reaction.

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;

namespace {

RigidBody brick() {
  return {.mass = 4,
          .inertia = Vector3d(1, 2, 2.5).asDiagonal(),
          .PA = {1, 2, 0},
          .children = {{"C1", {1, 0, 0}}}};
}

const Rotation kTurn = Rotation::about({1, 2, 3}, 0.7);

}  // namespace

TEST_CASE("a wrench on a body at the point of its mount acts on its parent") {
  // A is mounted on B at C1, turned: U on A there is U on B there.
  const auto scene = [](bool on_A, bool by_spring) {
    Diagram d{"on the parent"};
    auto U = d.input("U", 6);
    auto A = d.add("A", brick()), B = d.add("B", brick());
    B.parent.force = 0;
    const Rotation T = kTurn.named("B", "A");
    Eigen::Matrix<double, 6, 6> k = 70 * Eigen::Matrix<double, 6, 6>::Identity();
    if (by_spring) {
      auto S = bushing(d, "S", A.child, B.child("C1"), kTurn, {.stiffness = k, .damping = k / 9});
      A.parent.force = 0;
      on_A ? S.parent.force += -U : B.child("C1").force += T * U;
    } else {
      mount(A, B.child("C1"), kTurn);
      on_A ? A.parent.force += -U : B.child("C1").force += T * U;
    }
    d.output("a", 6) = A.parent.accel;
    return compile(d);
  };
  for (const bool by_spring : {false, true}) {
    CAPTURE(by_spring);
    const Complex s(0.3, 2.1);
    CHECK(matrix_error(scene(true, by_spring).transfer(s), scene(false, by_spring).transfer(s)) <=
          1e-14);
  }
  const System system = scene(true, false);
  CHECK(system.static_gain().norm() > 0.1);
}

TEST_CASE("a force without effect is refused: at a tied point whose reaction is not read") {
  const auto scene = [](bool reaction, bool ground_it = false) {
    Diagram d{"by hand"};
    auto u = d.input("u");
    auto a = d.add("a", SpringMass{.mass = 2, .stiffness = 26}),
         b = d.add("b", SpringMass{.mass = 3, .stiffness = 7, .parent_mass = 1.5});
    ground(a);
    if (ground_it) {
      ground(b);
    } else {
      b.parent.accel = a.child.accel;
      if (reaction)
        a.child.force = b.parent.reaction;
      else
        a.child.force = b.parent.force;
    }
    b.parent.force += -u;
    d.output("x") = a.child.accel;
    return d;
  };
  CHECK(says(compile_error(scene(false)), Code::two_equations,
             {"b.parent.accel = a.child.accel", "b.parent.force += -u", "reaction"}));
  CHECK(compile_error(scene(false, true)).mistakes().empty());  // the ground takes it
  // u at the point of masses 2 and 1.5 between springs of 26 and 7, with another mass of 3 on it.
  const Complex s(0.2, 1.3), t = 7.0 * 3.0 * s * s / (3.0 * s * s + 7.0);
  const Complex exact = s * s / (3.5 * s * s + 26.0 + t);
  CHECK(std::abs(compile(scene(true)).transfer(s)(0, 0) - exact) <= 1e-14 * std::abs(exact));
}

TEST_CASE("added forces with an effect are not refused: free directions, motion by a signal") {
  const auto by_parts = [](bool added) {  // B's point carries A's; A rotates under a torque
    Diagram d{"ball"};
    auto u = d.input("u", 3);
    auto A = d.add("A", brick()), B = d.add("B", brick());
    const Rotation T = kTurn.named("B", "A");
    B.parent.force = 0;
    A.parent.accel.linear = T.inverse() * B.child("C1").accel.linear;
    B.child("C1").force.linear = T * A.parent.force.linear;
    B.child("C1").force.angular = 0;
    if (added)
      A.parent.force.angular += -u;
    else
      A.parent.force.angular = -u;
    d.output("a", 6) = A.parent.accel;
    return d;
  };
  const System one = compile(by_parts(true)), other = compile(by_parts(false));
  CHECK(matrix_error(one.static_gain(), other.static_gain()) <= 1e-15);
  CHECK(one.static_gain().norm() > 0.1);

  Diagram d{"servo"};  // b's point follows, at any force
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 2, .stiffness = 26}),
       b = d.add("b", SpringMass{.mass = 3, .stiffness = 7});
  ground(a);
  b.parent.accel = -0.5 * a.child.accel;
  b.parent.force += -u;
  a.child.force = u;
  d.output("x") = b.child.accel;
  CHECK(compile_error(d).mistakes().empty());
}

TEST_CASE("points that are mounted on each other: refused, not written out for ever") {
  Diagram d{"round"};
  auto A = d.add("A", brick()), B = d.add("B", brick());
  mount(A, B.parent), mount(B, A.parent);
  const auto asked = next_line();
  d.output("r", 6) = A.parent.reaction;
  CHECK(says(compile_error(d), Code::ill_posed, {"A.parent", asked}));
}
