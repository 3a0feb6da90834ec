#include <doctest/doctest.h>

#include <complex>
#include <string>
#include <titop/titop.hpp>
#include <vector>

#include "support/rng.hpp"

/// Modes of one frequency that are not one mode: orders from theory, transfers in closed form.

using namespace titop;
using titop_test::Rng;

namespace {

using Complex = std::complex<double>;

/// Springs on the wall under one force; "y" is the sum of their stretches.
Diagram side_by_side(const std::vector<SpringMass>& springs, bool driven = true, bool seen = true) {
  Diagram d{"side by side"};
  std::vector<decltype(d.add("", SpringMass{}))> z;
  for (const SpringMass& s : springs) {
    z.push_back(d.add("z" + std::to_string(z.size() + 1), s));
    ground(z.back());
  }
  if (driven) {
    auto u = d.input("u");
    for (auto& one : z) one.child.force = u;
  } else {
    for (auto& one : z) one.child.force = 0;
  }
  if (seen) {
    auto sum = z[0].stretch + z[1].stretch;
    for (std::size_t i = 2; i < z.size(); ++i) sum = sum + z[i].stretch;
    d.output("y") = sum;
  }
  return d;
}

/// Transfer of a mass of 1 kg.
Complex gain(double stiffness, double damping, Complex s) {
  return 1.0 / (s * s + damping * s + stiffness);
}

void check_order(const System& s, int order) {
  CHECK(s.state_space().order() == order);
  CHECK(s.order_verdict().lowest == order);
  CHECK(s.order_verdict().highest == order);
  CHECK(certify(s).faults.empty());
}

}  // namespace

TEST_CASE("minimal: equal frequencies with different damping are different modes") {
  const std::vector<SpringMass> two = {{.mass = 1, .stiffness = 3, .damping = 0.25},
                                       {.mass = 1, .stiffness = 3, .damping = 0.125}};
  for (const bool driven : {true, false})
    for (const bool seen : {true, false}) {
      if (!driven && !seen) continue;
      CAPTURE(driven);
      CAPTURE(seen);
      check_order(compile(side_by_side(two, driven, seen)), 4);
    }
  // With equal damping one of the two is not seen.
  check_order(compile(side_by_side({two[0], two[0]})), 2);
  // Three, two of them equal; their order in the scene does not matter.
  check_order(compile(side_by_side({two[0], two[1], two[0]})), 4);
}

TEST_CASE("minimal: a little damping beside none is seen at the resonance") {
  const std::vector<SpringMass> two = {{.mass = 1, .stiffness = 1},
                                       {.mass = 1, .stiffness = 1, .damping = 2e-9}};
  const System s = compile(side_by_side(two));
  const Complex at(0, 1 + 1e-10);
  const Complex right = gain(1, 0, at) + gain(1, 2e-9, at);
  CHECK(std::abs(s.state_space().transfer(at)(0, 0) / right - 1.0) <= 1e-5);
  CHECK(s.state_space().order() == 4);
}

TEST_CASE("minimal: strong damping beside them does not make two modes one") {
  const std::vector<SpringMass> four = {{.mass = 1, .stiffness = 4},
                                        {.mass = 1, .stiffness = 4, .damping = 4e-9},
                                        {.mass = 1, .stiffness = 4, .damping = 20},
                                        {.mass = 50, .stiffness = 0.5}};
  const System s = compile(side_by_side(four));
  CHECK(s.state_space().order() == 8);
  const Complex at(0, 2 + 1e-9);
  const Complex right =
      gain(4, 0, at) + gain(4, 4e-9, at) + gain(4, 20, at) + 1.0 / (50.0 * at * at + 0.5);
  CHECK(std::abs(s.state_space().transfer(at)(0, 0) / right - 1.0) <= 1e-5);
}

TEST_CASE("minimal: two overdamped modes with one pole in common") {
  // 1 / ((s + 1)(s + 2)) + 1 / ((s + 1)(s + 3))
  check_order(compile(side_by_side({{.mass = 1, .stiffness = 2, .damping = 3},
                                    {.mass = 1, .stiffness = 3, .damping = 4}})),
              3);
}

TEST_CASE("minimal: equal wings of different damping on a hub") {
  // The wings mix in the modes of the springs alone: only damping distinguishes them.
  Diagram d{"wings"};
  auto u = d.input("u");
  auto hub = d.add("hub", SpringMass{.mass = 2, .stiffness = 0.5, .damping = 0.05});
  ground(hub);
  auto left = d.add("left", SpringMass{.mass = 1, .stiffness = 3, .damping = 0.1});
  auto right = d.add("right", SpringMass{.mass = 1, .stiffness = 3, .damping = 0.2});
  for (auto* wing : {&left, &right}) {
    mount(*wing, hub.child);
    wing->child.force = 0;
  }
  hub.child.force += u;
  d.output("x") = hub.stretch;
  const System s = compile(d);
  check_order(s, 6);
  const Complex at(0.01, 1.7);
  const auto carried = [&](double c) {  // force of a wing on the hub, over s^2 x
    const Complex spring = c * at + 3.0;
    return spring / (at * at + spring);
  };
  const Complex x = 1.0 / (at * at * (2.0 + carried(0.1) + carried(0.2)) + 0.05 * at + 0.5);
  CHECK(std::abs(s.state_space().transfer(at)(0, 0) / x - 1.0) <= 1e-12);
}

TEST_CASE("minimal: an output of positions and rates may leave out one pole of a mode") {
  // (1 + s) / (s^2 + 4 s + 3) = 1 / (s + 3)
  Diagram d{"overdamped"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 3, .damping = 4});
  ground(z);
  z.child.force = u;
  d.output("y") = z.stretch + 1.0 * z.child.rate;
  check_order(compile(d), 1);
}

TEST_CASE("minimal: motion in phase between two springs is seen, motion in opposition is not") {
  // y = (u + s v) / (s^2 + 4): two states, of which the scene has four.
  Diagram d{"turning"};
  auto u = d.input("u");
  auto v = d.input("v");
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
  auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 4});
  ground(a);
  ground(b);
  a.child.force = u;
  b.child.force = v;
  d.output("y") = a.stretch + 1.0 * b.child.rate;
  const System s = compile(d);
  CHECK(s.state_space().order() == 2);
  const Complex at(0.1, 0.7);
  const auto G = s.state_space().transfer(at);
  CHECK(std::abs(G(0, 0) * (at * at + 4.0) - 1.0) <= 1e-13);
  CHECK(std::abs(G(0, 1) * (at * at + 4.0) / at - 1.0) <= 1e-13);
}

TEST_CASE("minimal: of three equal modes of one body, the two that move, at any frequency") {
  // The base turns the second by rz, the third by ry and rz; the first is seen at C, and does not
  // move. Moments on the base see two directions: two modes, four states.
  Rng rng(4);
  for (int trial = 0; trial < 30; ++trial) {
    CAPTURE(trial);
    ModalData m;
    m.omega = Eigen::VectorXd::Constant(3, rng.between(0.5, 200));
    m.xi = Eigen::VectorXd::Constant(3, rng.between(0.001, 0.3));
    m.L_P = Eigen::MatrixXd::Zero(3, 6);
    m.L_P(1, 5) = m.L_P(2, 4) = m.L_P(2, 5) = 1;
    m.D_P = 10 * Matrix6::Identity();
    Eigen::MatrixXd Phi = Eigen::MatrixXd::Zero(6, 3);
    Phi.row(5) = rng.matrix(1, 3);
    m.children.push_back({"C", {1, 0, 0}, Phi});
    Diagram d{"prescribed"};
    auto hub = d.add("hub", RigidBody{.mass = 10, .inertia = {1, 2, 3}, .children = {{"S"}}});
    auto body = d.add("body", FlexibleBody(m));
    hub.parent.accel = d.input("a", 6);
    mount(body, hub.child("S"));
    d.output("wrench", 6) = hub.parent.force;
    d.output("motion", 6) = body.child("C").accel;
    check_order(compile(d), 4);
  }
}
