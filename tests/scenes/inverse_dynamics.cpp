#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/mistakes.hpp"

/// A motion is given at one port, the effort at another is asked for: the inverse of the model, if
/// the effort acts on the motion at once.

using namespace titop;
using Complex = std::complex<double>;

TEST_CASE("inverse dynamics: the torque of a drive for an acceleration of the arm's tip") {
  const double length = 1.5, inertia = 0.4 + 2 * 0.7 * 0.7, k = 30, c = 0.2;
  Diagram d{"arm"};
  auto arm = d.add("arm", RigidBody{.mass = 2,
                                    .inertia = {0.3, 0.3, 0.4},
                                    .PA = {0.7, 0, 0},
                                    .children = {{"tip", {length, 0, 0}}}});
  auto base = d.add("base", RigidBody{.mass = 1, .children = {{"C"}}});
  ground(base);
  auto h = hinge(d, "drive", arm, base.child("C"), Rotation(), {0, 0, 1});
  h.torque = k * h.angle + c * h.rate - d.input("torque");
  d.output("tip") = arm.child("tip").along({0, 1, 0}).accel;
  const StateSpace inverse = invert(compile(d).state_space(), {{0, 0}});
  CHECK(inverse.inputs == std::vector<std::string>{"tip"});
  CHECK(inverse.outputs == std::vector<std::string>{"torque"});
  for (const Complex s : {Complex(0.1, 1), {0, 20}, {3, 0}}) {
    const Complex torque = (inertia + c / s + k / (s * s)) / length;  // per unit acceleration
    CHECK(std::abs(inverse.transfer(s)(0, 0) / torque - 1.0) <= 1e-12);
  }
}

TEST_CASE(
    "inverse dynamics: through a spring the acceleration follows later, there is no inverse") {
  Diagram d{"two masses"};
  auto first = d.add("first", SpringMass{.mass = 2}),
       second = d.add("second", SpringMass{.mass = 1, .stiffness = 5});
  ground(first);
  mount(second, first.child);
  first.child.force += d.input("u");
  d.output("a") = second.child.accel;
  const StateSpace model = compile(d).state_space();
  CHECK(titop_test::says(titop_test::error_of([&] {
                           (void)invert(model, {{0, 0}});
                         }),
                         Code::improper, {"rank"}));
}

TEST_CASE("inverse of a model: numbers that are not there, and a direct term of rounding") {
  using titop_test::error_of;
  using titop_test::says;
  StateSpace m;
  m.D = Eigen::Matrix2d{{1e-17, 1}, {1, 1}};
  m.inputs = {"u", "v"}, m.outputs = {"x", "y"};
  m.A.resize(0, 0), m.B.resize(0, 2), m.C.resize(2, 0);
  const auto refused = [&](const std::vector<std::pair<int, int>>& pairs) {
    return error_of([&] { (void)invert(m, pairs); });
  };
  CHECK(says(refused({{0, 3}}), Code::bad_value, {"output 3", "2"}));
  CHECK(says(refused({{-1, 0}}), Code::bad_value, {"input -1"}));
  CHECK(says(refused({{0, 0}, {0, 1}}), Code::bad_value, {"input 0", "two"}));
  CHECK(says(refused({{0, 0}}), Code::improper, {"u", "x", "0 of 1"}));  // 1e-17 is a 0
  StateSpace unnamed = m;
  unnamed.inputs.clear();
  CHECK(says(error_of([&] { (void)invert(unnamed, {{0, 0}}); }), Code::size, {"0 names", "2 x 2"}));
  const StateSpace both = invert(m, {{0, 0}, {1, 1}});
  CHECK((both.D * m.D - Eigen::Matrix2d::Identity()).norm() <= 1e-15);
}
