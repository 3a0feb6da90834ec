#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "support/names.hpp"

/// The verdict of `minimize` on the order, with the model.

using namespace titop;
using Eigen::MatrixXd;
using titop_test::has_name;
using titop_test::has_names;
using titop_test::two_digits;

namespace {

/// Two masses on a third, which is pushed; the third is watched.
StateSpace pair(double k1, double k2) {
  Diagram d{"pair"};
  auto u = d.input("u");
  auto hub = d.add("hub", SpringMass{.mass = 4, .stiffness = 64});
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = k1});
  auto b = d.add("b", SpringMass{.mass = 1, .stiffness = k2});
  ground(hub);
  mount(a, hub.child);
  mount(b, hub.child);
  hub.child.force += u;
  d.output("x") = hub.stretch;
  return compile(d, {.minimize_up_to = 0}).state_space();
}

StateSpace model(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C) {
  StateSpace m{A, B, C, MatrixXd::Zero(C.rows(), B.cols()), {}, {}, {}};
  for (Eigen::Index i = 0; i < A.rows(); ++i) m.states.push_back("x" + std::to_string(i));
  for (Eigen::Index i = 0; i < B.cols(); ++i) m.inputs.push_back("u" + std::to_string(i));
  for (Eigen::Index i = 0; i < C.rows(); ++i) m.outputs.push_back("y" + std::to_string(i));
  return m;
}

}  // namespace

TEST_CASE(
    "an equal pair: order 4 of 6, decided; removed states, their error, and that of the next") {
  const Minimized r = minimize(pair(25, 25));
  CHECK(r.model.order() == 4);
  CHECK(r.order.decided());
  CHECK(r.order.order == 4);
  REQUIRE(r.order.removed.size() == 1);
  CHECK(r.order.removed[0].states == 2);
  CHECK(std::abs(r.order.removed[0].omega - 5) <=
        1e-14 * 5);  // sqrt(25 / 1), both against each other
  CHECK(r.order.to_more <= 1e-17);
  CHECK(r.order.to_fewer >= 1e-4);
  const std::string text = to_string(r.order);
  CHECK(has_names(text, {"order 4", "2 states", "5 rad/s", two_digits(r.order.to_fewer)}));
  CHECK(r.notes.front() == text);
}

TEST_CASE("update judges nothing, the dense model of the new values does: 6, 4 and 6 states") {
  Diagram d{"pair"};
  auto u = d.input("u");
  auto hub = d.add("hub", SpringMass{.mass = 4, .stiffness = 64});
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 25});
  auto b = d.add("b", SpringMass{.mass = 1, .stiffness = d.param("k", 49)});
  ground(hub);
  mount(a, hub.child);
  mount(b, hub.child);
  hub.child.force += u;
  d.output("x") = hub.stretch;
  const System first = compile(d), equal = first.update({{"k", 25}}),
               apart = equal.update({{"k", 36}});
  CHECK(equal.order() == 6);  // states keep number and meaning
  CHECK(first.state_space().order() == 6);
  CHECK(equal.state_space().order() == 4);
  CHECK(equal.order_verdict().decided());
  CHECK(apart.state_space().order() == 6);
  CHECK(compile(d, {.minimize_up_to = 0}).update({{"k", 25}}).state_space().order() == 6);
}

TEST_CASE("a pair that differs by 1e-6 keeps its 6 states and reports their visibility") {
  const Minimized r = minimize(pair(25, 25 * (1 + 1e-6)));
  CHECK(r.model.order() == 6);
  CHECK(r.order.decided());
  CHECK(r.order.removed.empty());
  // Driven and seen in proportion to the difference: visibility is quadratic in it.
  const double here = r.order.to_fewer;
  const double there = minimize(pair(25, 25 * (1 + 1e-5))).order.to_fewer;
  CHECK(std::abs(there / here - 100) <= 1);
  CHECK(minimize(pair(25, 25 * (1 + 1e-6)), {.resolution = 2 * here}).model.order() == 4);
}

TEST_CASE("the exact order decides where visibility does not") {
  const StateSpace m = pair(25, 25 * (1 + 1e-6));
  const Minimized told = minimize(m, {.exact_order = 4});
  CHECK(told.model.order() == 4);
  CHECK(told.order.exact);
  CHECK(has_names(to_string(told.order), {"exact", "order 4"}));
  // The mode's input and output vectors are each 1e-6: their product is not detected.
  REQUIRE(told.order.removed.size() == 1);
  CHECK(told.order.removed[0].visibility > 1e-14);
  CHECK(told.order.change > told.order.removed[0].visibility);
  CHECK(told.order.change <= 100 * told.order.removed[0].visibility);
  // The dual model, whose inputs hardly move it.
  const Minimized dual = minimize(
      {m.A.transpose(), m.C.transpose(), m.B.transpose(), m.D.transpose(), m.states, {"v"}, {"z"}},
      {.exact_order = 4});
  CHECK(dual.model.order() == 4);
  CHECK(dual.order.change <= 100 * told.order.removed[0].visibility);
  // Never a mode that can be seen: 2 of 4 would be wrong, and is not done.
  const Minimized wrong = minimize(pair(25, 100), {.exact_order = 2});
  CHECK(wrong.model.order() == 6);
  CHECK(wrong.notes.size() == 2);
}

TEST_CASE("a state removed by a wrong exact order is restored, with the change measured") {
  // 1 / (s + 1) + c / (s + 3)
  const auto sum = [](double c) {
    return model(MatrixXd{{-1, 0}, {0, -3}}, MatrixXd{{1}, {1}}, MatrixXd{{1, c}});
  };
  const std::complex<double> s(0.3, 3);  // near the second pole
  for (const double c : {3e-8, 1e-6}) {
    const Minimized r = minimize(sum(c), {.exact_order = 1});
    CHECK(r.model.A == sum(c).A);
    CHECK(r.model.C == sum(c).C);
    CHECK(r.order.order == 2);
    CHECK(r.order.removed.empty());
    const double missed = std::abs(c / (s + 3.0)) / std::abs(1.0 / (s + 1.0) + c / (s + 3.0));
    CHECK(has_name(r.notes.back(), two_digits(missed)));
  }
  // Below 1e-8 it may leave, and the change is reported.
  const Minimized r = minimize(sum(1e-9), {.exact_order = 1});
  CHECK(r.model.order() == 1);
  CHECK(r.order.change > 1e-10);
  CHECK(r.order.change < 1e-8);
}

TEST_CASE("poles at 0: ranks show how many are needed") {
  // Two integrators of one input, added up: one will do.
  const Minimized both =
      minimize(model(MatrixXd::Zero(2, 2), MatrixXd::Ones(2, 1), MatrixXd::Ones(1, 2)));
  CHECK(both.model.order() == 1);
  CHECK(both.order.decided());
  // Two that act on another pole: 2 / (s (s + 2)).
  const Minimized inner = minimize(model(MatrixXd{{0, 0, 0}, {0, 0, 0}, {1, 1, -2}},
                                         MatrixXd{{1}, {1}, {0}}, MatrixXd{{0, 0, 1}}));
  CHECK(inner.order.decided());
  CHECK(inner.model.order() == 2);
  // A double integrator, and one with an oscillation.
  CHECK(minimize(model(MatrixXd{{0, 1}, {0, 0}}, MatrixXd{{0}, {1}}, MatrixXd{{1, 0}}))
            .order.decided());
  const Minimized mixed =
      minimize(model(MatrixXd{{0, 1, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 1}, {0, 0, -4, -0.1}},
                     MatrixXd{{0}, {1}, {0}, {1}}, MatrixXd{{1, 0, 1, 0}}));
  CHECK(mixed.order.decided());
  CHECK(mixed.order.order == 4);
}

TEST_CASE("uncoupled states of any size: the effect of one input on one hides no other") {
  // 1e-1 * 1e3 / (s + 20), and a pole with input 1e16 and output 0, or 1e-16.
  const MatrixXd A{{-20, 0}, {0, -10}}, B{{0.1}, {1e16}};
  CHECK(minimize(model(A, B, MatrixXd{{1000, 0}})).model.order() == 1);
  const Minimized both = minimize(model(A, B, MatrixXd{{1000, 1e-16}}));
  CHECK(both.model.order() == 2);
  CHECK(both.order.decided());
}

TEST_CASE("equal real poles are rotated until the unreachable one is separate") {
  // Three copies of 1/(s + 2) behind one input, seen together and apart.
  const MatrixXd A = -2 * MatrixXd::Identity(3, 3);
  const Minimized r = minimize(model(A, MatrixXd{{1}, {2}, {3}}, MatrixXd{{1, 1, 1}, {1, 0, 0}}));
  CHECK(r.model.order() == 1);
  CHECK(r.order.decided());
  const Minimized two =
      minimize(model(A, MatrixXd{{1, 0}, {2, 1}, {3, 0}}, MatrixXd{{1, 1, 1}, {1, 0, 0}}));
  CHECK(two.model.order() == 2);
  CHECK(two.order.decided());
}

TEST_CASE("not judged: larger than Options::minimize_up_to") {
  Diagram d{"one"};
  auto z = d.add("z", SpringMass{});
  ground(z);
  z.child.force += d.input("u");
  d.output("x") = z.position;
  const System system = compile(d, {.minimize_up_to = 1});
  CHECK(!system.order_verdict().judged);
  CHECK(!system.order_verdict().decided());
  CHECK(has_name(to_string(system.order_verdict()),
                 fmt::format("order {}", system.order_verdict().order)));
}

TEST_CASE(
    "two equal beams on a hub whose attitude is read: modes without motion of the hub leave") {
  for (const int elements : {1, 2})
    for (const bool at_tip : {false, true}) {
      CAPTURE(elements);
      CAPTURE(at_tip);
      const Beam beam{.length = 1,
                      .section = tube(0.04, 0.03),
                      .material = {.E = 70e9, .nu = 0.25, .rho = 2700},
                      .elements = elements};
      Diagram d{"mirrored"};
      auto U = d.input("U", 6);
      auto hub = d.add("hub", RigidBody{.mass = 20,
                                        .inertia = Eigen::Vector3d(2, 3, 4).asDiagonal(),
                                        .children = {{"A", {0.5, 0, 0}}, {"B", {-0.5, 0, 0}}}});
      auto a = d.add("a", FlexibleBody{beam}), b = d.add("b", FlexibleBody{beam});
      hub.parent.force = -U;
      mount(a, hub.child("A"));
      mount(b, hub.child("B"), Rotation::about({0, 0, 1}, std::numbers::pi));
      if (at_tip)
        d.output("acc", 6) = a.child.accel;
      else
        d.output("acc", 6) = hub.parent.accel;
      d.output("attitude", 3) = hub.parent.position.angular();
      const System system = compile(d);
      // Three angles and their rates; per element and beam six modes, of which one of extension and
      // one of torsion pull and turn the hub both ways at once.
      const int order = 6 + elements * (2 * 12 - 2 * 2);
      CHECK(system.order() == 6 + elements * 2 * 12);
      CHECK(system.state_space().order() == order);
      CHECK(system.order_verdict().lowest <= order);
      CHECK(system.order_verdict().highest >= order);
    }
}

TEST_CASE("a light node blurs the modes that it takes part in, not those of others") {
  // [[k, -k], [-k, k + 1]] with k = 1e12 has a pivot of 1e-12 of its diagonal; with it two modes
  // that differ by 0.15 % and two of one frequency, of which one is never moved.
  const Eigen::Index n = 6;
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  S.topLeftCorner(2, 2) << 1e12, -1e12, -1e12, 1e12 + 1;
  S.diagonal().tail(4) << 1e6, 1.003e6, 0.25, 0.25;
  StateSpace m;
  m.A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  m.A.topRightCorner(n, n).setIdentity();
  m.A.bottomLeftCorner(n, n) = -S;
  m.B = Eigen::MatrixXd::Zero(2 * n, 1);
  m.B.bottomRows(4).setOnes();
  m.C = Eigen::MatrixXd::Zero(1, 2 * n);
  m.C.middleCols(2, 4).setOnes();
  m.D = Eigen::MatrixXd::Zero(1, 1);
  for (int i = 0; i < 2 * n; ++i) m.states.push_back("x" + std::to_string(i));
  m.inputs = {"u"}, m.outputs = {"y"};
  const Minimized r = minimize(m);
  CHECK(r.order.order == 6);
  const std::complex<double> s(0.5, 1000.7);
  CHECK(std::abs(r.model.transfer(s)(0, 0) / m.transfer(s)(0, 0) - 1.0) <= 1e-9);
}

TEST_CASE(
    "two equal masses on a point of hardly any mass: kept or not, it is not called decided in "
    "error") {
  Diagram d{"light node"};
  auto u = d.input("u");
  auto node = d.add("node", SpringMass{.mass = 1e-12, .stiffness = 0.3});
  ground(node);
  std::vector<SpringMass::Handle> z;
  for (const char* name : {"a", "b"}) {
    z.push_back(d.add(name, SpringMass{.mass = 1.3, .stiffness = 1.7}));
    mount(z.back(), node.child);
    z.back().child.force = u;
  }
  d.output("x") = z[0].stretch;
  const System s = compile(d);
  const OrderVerdict v = s.order_verdict();
  CAPTURE(to_string(v));
  CHECK(v.lowest <= 4);  // the two swing against each other unmoved
  CHECK(v.highest >= 4);
}
