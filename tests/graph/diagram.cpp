#include <doctest/doctest.h>

#include <titop/titop.hpp>
#include <type_traits>

#include "support/close.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;

namespace {

const Complex kS(0.3, 1.7);

SpringMass spring(double mass = 2, double stiffness = 26) {
  return SpringMass{.mass = mass, .stiffness = stiffness};
}

/// Two masses in a row under a force, with the position of the second one.
Diagram two() {
  Diagram d{"two"};
  auto u = d.input("u");
  auto z1 = d.add("z1", spring()), z2 = d.add("z2", spring(3, 7));
  ground(z1);
  mount(z2, z1.child);
  z2.child.force = u;
  d.output("x") = z2.position;
  return d;
}

StateSpace model(const Diagram& d) { return compile(d).state_space(); }

std::vector<std::string> node_order(const Diagram& d) {
  const System system = compile(d);
  std::vector<std::string> names;
  for (const Node& n : system.stage().graph.nodes) names.push_back(n.name);
  return names;
}

}  // namespace

TEST_CASE("a diagram moves, does not copy; handles follow it") {
  static_assert(!std::is_copy_constructible_v<Diagram> && !std::is_copy_assignable_v<Diagram>);
  static_assert(std::is_nothrow_move_constructible_v<Diagram>);
  Diagram first{"moved"};
  auto z = first.add("z", spring());
  Diagram second = std::move(first);
  ground(z);
  second.output("x") = z.stretch;
  CHECK(model(second).order() == 2);
}

TEST_CASE("clone() is independent of the original") {
  Diagram d = two();
  Diagram copy = d.clone();
  CHECK(copy.name() == "two");
  CHECK(difference(model(copy), model(d)) == "");
  auto z3 = copy.add("z3", spring());
  ground(z3);
  copy.output("more") = z3.stretch;
  CHECK(d.graph().nodes.size() == 2);
  CHECK(model(d).outputs == std::vector<std::string>{"x"});
  CHECK(model(copy).outputs == std::vector<std::string>{"x", "more"});
}

TEST_CASE("inputs, outputs and states come out as declared; inside, names decide") {
  Diagram d{"order"};
  auto w = d.input("w", 2);
  auto u = d.input("u");
  auto z10 = d.add("z10", spring()), z2 = d.add("z2", spring()), z1 = d.add("z1", spring());
  d.output("y") = z2.stretch;
  d.output("b", 2) = w;
  d.output("a") = z10.stretch + z1.stretch;
  ground(z1), ground(z2), ground(z10);
  z1.child.force = u;
  z2.child.force = Eigen::MatrixXd::Ones(1, 2) * w;
  z10.child.force = u;
  const StateSpace m = compile(d, {.minimize_up_to = 0}).state_space();
  CHECK(m.inputs == std::vector<std::string>{"w(1)", "w(2)", "u"});
  CHECK(m.outputs == std::vector<std::string>{"y", "b(1)", "b(2)", "a"});
  CHECK(m.states == std::vector<std::string>{"z10.stretch", "z10.stretch_rate", "z2.stretch",
                                             "z2.stretch_rate", "z1.stretch", "z1.stretch_rate"});
  CHECK(node_order(d) == std::vector<std::string>{"z1", "z2", "z10"});
}

TEST_CASE("natural order of names") {
  const std::vector<std::string> ordered{"A",   "a",    "a1",    "a1b", "a2",  "a02",
                                         "a10", "a10a", "a100b", "b",   "b.1", "b1"};
  for (std::size_t i = 0; i < ordered.size(); ++i)
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      CAPTURE(ordered[i]);
      CAPTURE(ordered[j]);
      const int sign = natural_compare(ordered[i], ordered[j]);
      if (ordered[i] == "a02" && ordered[j] == "a2") {
        CHECK(sign != 0);  // different names, whichever comes first
      } else if (ordered[i] != "a2" || ordered[j] != "a02") {
        CHECK((sign > 0) == (i > j));
        CHECK((sign == 0) == (i == j));
      }
    }
}

TEST_CASE("Gain, Sum and MatrixGain are the same as written inline") {
  const auto scene = [](bool nodes) {
    Diagram d{"nodes"};
    auto u = d.input("u"), v = d.input("v");
    auto z1 = d.add("z1", spring()), z2 = d.add("z2", spring(3, 7));
    ground(z1), ground(z2);
    const Eigen::MatrixXd M{{0.3, -1.7}};
    if (nodes) {
      auto k = d.add("k", Gain{.gain = 4.25});
      auto sum = d.add("sum", Sum{.signs = "+-+"});
      auto mix = d.add("mix", MatrixGain{.matrix = M});
      auto pair = d.input("pair", 2);
      k.in = z1.stretch;
      sum.in(1) = u;
      sum.in(2) = k.out;
      sum.in(3) = v;
      z1.child.force = sum.out;
      mix.in = pair;
      z2.child.force = mix.out;
    } else {
      auto pair = d.input("pair", 2);
      z1.child.force = u - 4.25 * z1.stretch + v;
      z2.child.force = M * pair;
    }
    d.output("x1") = z1.stretch;
    d.output("x2") = z2.stretch;
    return model(d);
  };
  CHECK(difference(scene(true), scene(false)) == "");
}

TEST_CASE("an Integrator is the Lti 1/s, with the quantity that it integrates to") {
  const auto scene = [](bool own) {
    Diagram d{"integrators"};
    auto u = d.input("u");
    auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 26, .parent_mass = 1});
    z.parent.force = -u;
    const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1), none = Eigen::MatrixXd::Zero(1, 1);
    auto v = own ? d.add("v", Integrator{}) : d.add("v", Lti{none, one, one, none});
    auto x = own ? d.add("x", Integrator{}) : d.add("x", Lti{none, one, one, {}});
    v.in = z.parent.accel;
    x.in = v.out;
    d.output("x") = x.out;
    d.output("x_C") = x.out + (own ? z.stretch + Expr{} : 1 * z.stretch);
    return model(d);
  };
  const StateSpace m = scene(true);
  CHECK(difference(m, scene(false)) == "");
  // u moves m0 = 1 kg with m = 2 kg behind k = 26 N/m.
  const Complex s2 = kS * kS, den = (s2 + 26.0) * (2.0 * s2 + 26.0) - 26.0 * 26.0;
  CHECK(relative(m.transfer(kS)(0, 0), (2.0 * s2 + 26.0) / den) <= 1e-13);
  CHECK(relative(m.transfer(kS)(1, 0), 26.0 / den) <= 1e-13);
}

TEST_CASE("a controller written as a node acts like its transfer") {
  Diagram d{"controller"};
  auto u = d.input("u");
  auto z = d.add("z", spring());
  auto K = d.add("K", Lti{.A = Eigen::MatrixXd{{-3}},
                          .B = Eigen::MatrixXd{{2}},
                          .C = Eigen::MatrixXd{{5}},
                          .D = Eigen::MatrixXd{{0.5}}});
  ground(z);
  K.in = z.stretch;
  z.child.force = u - K.out;
  d.output("x") = z.stretch;
  const Complex k = 10.0 / (kS + 3.0) + 0.5;
  CHECK(relative(model(d).transfer(kS)(0, 0), 1.0 / (2.0 * kS * kS + 26.0 + k)) <= 1e-14);
}

TEST_CASE("positions are sums of stretches down to the ground, also through turned blocks") {
  Diagram d{"positions"};
  auto u = d.input("u");
  auto z1 = d.add("z1", spring()), z2 = d.add("z2", spring(3, 7));
  auto z3 = d.add("z3", SpringMass{.mass = 1, .stiffness = 9, .parent_mass = 0.5});
  ground(z1);
  mount(z2, z1.child);
  z3.child.accel = z2.child.accel;
  z2.child.force = u - z3.child.force;
  release(z3);
  d.output("x2") = z2.position;
  d.output("sum") = z1.stretch + z2.stretch;
  d.output("wall") = z1.parent.position;
  d.output("end") = z3.parent.position;
  d.output("end by hand") = z1.stretch + z2.stretch - z3.stretch;
  const StateSpace m = model(d);
  CHECK(m.C.row(0) == m.C.row(1));
  CHECK(m.C.row(2).isZero(0));
  CHECK(m.C.row(3) == m.C.row(4));
  CHECK(m.D.isZero(0));
}

TEST_CASE("positions of bodies follow their mounting") {
  Diagram d{"positions"};
  auto t = d.input("t");
  const Vector3d PC(1, 2, 3);
  auto B = d.add("B", RigidBody{.mass = 4, .children = {{"C1", PC}}});
  auto A = d.add("A", RigidBody{.mass = 2, .children = {{"F", PC}}});
  ground(B);
  const Rotation T = Rotation::about({1, 1, 0}, 0.4);
  auto h = hinge(d, "h", A, B.child, T, {0, 0, 2});
  h.torque = -t;
  d.output("F", 6) = A.child.position;
  d.output("by hand", 6) =
      tau(-PC) * Eigen::MatrixXd((Vector6() << 0, 0, 0, 0, 0, 1).finished()) * h.angle;
  const StateSpace m = model(d);
  CHECK(m.order() == 2);
  CHECK(matrix_error(m.C.topRows(6), m.C.bottomRows(6)) <= 1e-15);
}

TEST_CASE("positions and rates that no state determines are integrated, and only those") {
  Diagram d{"free"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 2, .stiffness = 26, .parent_mass = 1});
  auto z2 = d.add("z2", SpringMass{.mass = 3, .stiffness = 5});
  z1.parent.force = -u;
  z2.parent.accel = u;
  d.output("x1") = z1.position;  // free: two integrators for the chain
  d.output("x1P") = z1.parent.position;
  d.output("v1") = z1.child.rate;
  d.output("v2") = z2.child.rate;  // prescribed: one
  const System system = compile(d, {.minimize_up_to = 0});
  CHECK(system.states() == std::vector<std::string>{"z1.stretch", "z1.stretch_rate", "z2.stretch",
                                                    "z2.stretch_rate", "z1.parent.rate.x1",
                                                    "z2.parent.rate.x1", "z1.parent.position.x1"});
  const std::complex<double> s{0.3, 2};
  const Eigen::MatrixXcd G = system.transfer(s);
  CHECK(matrix_error(G, transfer(d.graph(), s)) <= 1e-14);
  // Free: 1 * x_P'' = u - f, 2 x_C'' = -26 (x_C - x_P).
  const std::complex<double> xC = 26.0 / (2.0 * s * s * s * s + 78.0 * s * s);
  CHECK(std::abs(G(0, 0) / xC - 1.0) <= 1e-14);
  CHECK(std::abs(G(3, 0) / (5.0 / (3.0 * s * s + 5.0) / s) - 1.0) <= 1e-14);
  CHECK(system.certificate().residual <= 1e-15);
}
