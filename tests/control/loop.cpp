#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Loop points: the diagram is the same with and without them, and L, S, T are those on paper.

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;
using Eigen::MatrixXd;

namespace {

constexpr double J = 3, kp = 2, kd = 5;

/// An inertia with a PD law, J qdd = -(kp q + kd qd) + w; with and without a loop point.
Diagram inertia(bool marked, double gain = kp) {
  Diagram d{"inertia"};
  auto w = d.input("w");
  auto k = d.param("kp", gain);
  auto hub = d.add("hub", RigidBody{.mass = 1, .inertia = J * Matrix3d::Identity()});
  const Expr law = k * hub.parent.position.angular().along({0, 0, 1}) +
                   kd * hub.parent.rate.angular().along({0, 0, 1});
  const MatrixXd z = Eigen::Vector3d::UnitZ();
  hub.parent.force.linear = 0;
  if (marked)
    hub.parent.force.angular = z * d.loop_point("torque", law) - z * w;
  else
    hub.parent.force.angular = z * law - z * w;
  d.output("angle") = hub.parent.position.angular().along({0, 0, 1});
  return d;
}

Complex scalar(const System& system, Complex s) { return system.transfer(s)(0, 0); }

const Complex kPoints[] = {{0.3, 0.7}, {0, 0.05}, {0, 4}, {-0.2, 9}};

}  // namespace

TEST_CASE("a loop point changes nothing") {
  const System with = compile(inertia(true)), without = compile(inertia(false));
  CHECK(with.order() == without.order());
  CHECK(with.inputs() == without.inputs());
  for (const Complex s : kPoints)
    CHECK(std::abs(scalar(with, s) - scalar(without, s)) <= 1e-14 * std::abs(scalar(with, s)));
  CHECK(loop_points(with) == std::vector<std::string>{"torque"});
  CHECK(loop_points(without).empty());
}

TEST_CASE("L, S and T of an inertia with a PD law, closed by 1 + L") {
  const System system = compile(inertia(true));
  const ControlLoop l = loop(system, "torque");
  CHECK(l.points == std::vector<std::string>{"torque"});
  CHECK(l.L.inputs() == l.points);
  CHECK(l.L.outputs() == l.points);
  for (const Complex s : kPoints) {
    const Complex L = (kp + kd * s) / (J * s * s);
    CHECK(std::abs(scalar(l.L, s) - L) <= 1e-13 * std::abs(L));
    CHECK(std::abs(scalar(l.S, s) - 1.0 / (1.0 + L)) <= 1e-13 * std::abs(1.0 / (1.0 + L)));
    CHECK(std::abs(scalar(l.T, s) - L / (1.0 + L)) <= 1e-13 * std::abs(L / (1.0 + L)));
  }
  CHECK(l.L.state_space().order() == 2);
  CHECK(l.S.state_space().order() == 2);
}

TEST_CASE("a law with states on a free hub's attitude, whatever the names") {
  // The cut parts the law from the hub: the nodes, and the integrators of the attitude among them,
  // come in another order. L = 5 (kd s + kp) / ((s + 5) J s^2).
  for (const auto& [hub_name, law_name] : {std::pair{"hub", "law"}, {"z", "a"}, {"a", "z"}}) {
    Diagram d{"attitude"};
    auto w = d.input("w");
    auto hub = d.add(hub_name, RigidBody{.mass = 1, .inertia = J * Matrix3d::Identity()});
    auto law = d.add(law_name, Lti{.A = MatrixXd::Constant(1, 1, -5),
                                   .B = MatrixXd::Constant(1, 1, 1),
                                   .C = MatrixXd::Constant(1, 1, 5 * kp - 25 * kd),
                                   .D = MatrixXd::Constant(1, 1, 5 * kd)});
    const MatrixXd z = Eigen::Vector3d::UnitZ();
    law.in = hub.parent.position.angular().along({0, 0, 1});
    hub.parent.force.linear = 0;
    hub.parent.force.angular = z * d.loop_point("torque", law.out) - z * w;
    d.output("angle") = hub.parent.position.angular().along({0, 0, 1});
    const ControlLoop l = loop(compile(d), "torque");
    for (const Complex s : kPoints) {
      const Complex L = 5.0 * (kd * s + kp) / ((s + 5.0) * J * s * s);
      CHECK(std::abs(scalar(l.L, s) - L) <= 1e-13 * std::abs(L));
      CHECK(std::abs(scalar(l.S, s) - 1.0 / (1.0 + L)) <= 1e-13 * std::abs(1.0 / (1.0 + L)));
      CHECK(std::abs(scalar(l.T, s) - L / (1.0 + L)) <= 1e-13 * std::abs(L / (1.0 + L)));
    }
    CHECK(l.L.state_space().order() == 3);
  }
}

TEST_CASE("parameters of the system, and of the loop itself") {
  const System system = compile(inertia(true)).update({{"kp", 7.0}});
  const ControlLoop l = loop(system, "torque");
  const Complex s{0.1, 2}, L = (7.0 + kd * s) / (J * s * s), K = (1.0 + kd * s) / (J * s * s);
  CHECK(std::abs(scalar(l.L, s) - L) <= 1e-13 * std::abs(L));
  CHECK(std::abs(scalar(l.L.update({{"kp", 1.0}}), s) - K) <= 1e-13 * std::abs(K));
}

TEST_CASE("three axes at once, and one of two cuts") {
  // The torque h z x omega couples two axes: J qdd + h [0 1; -1 0] qd = -K q - C qd.
  constexpr double h = 4;
  Diagram d{"coupled"};
  auto hub = d.add("hub", RigidBody{.mass = 1, .inertia = J * Matrix3d::Identity()});
  momentum(hub.parent, h, {0, 0, 1});
  const auto turn = hub.parent.position.angular();
  const auto rate = hub.parent.rate.angular();
  const MatrixXd x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                 z = Eigen::Vector3d::UnitZ();
  hub.parent.force.linear = 0;
  auto law = [&](const char* name, const Vector3d& r, double k) {
    return d.loop_point(name, k * turn.along(r) + kd * rate.along(r));
  };
  const auto x_torque = law("x", {1, 0, 0}, 2), y_torque = law("y", {0, 1, 0}, 6),
             z_torque = law("z", {0, 0, 1}, 1);
  hub.parent.force.angular = x * x_torque + y * y_torque + z * z_torque;
  d.output("turn", 3) = turn;
  const System system = compile(d);
  CHECK(loop_points(system) == std::vector<std::string>{"x", "y", "z"});
  for (const Complex s : kPoints) {
    Eigen::Matrix2cd M, K;
    M << J * s * s, h * s, -h * s, J * s * s;
    K << 2.0 + kd * s, 0, 0, 6.0 + kd * s;
    // Names are in the caller's order.
    Eigen::Matrix2cd flip;
    flip << 0, 1, 1, 0;
    const Eigen::Matrix2cd L = K * M.inverse();
    const Eigen::MatrixXcd both = mimo_loop(system, {"y", "x"}).L.transfer(s);
    CHECK((both - flip * L * flip).norm() <= 1e-13 * L.norm());
    // With y closed: eliminated by hand.
    const Complex a = both(1, 1), alone = a - both(1, 0) / (1.0 + both(0, 0)) * both(0, 1);
    const Complex one = loop(system, "x").L.transfer(s)(0, 0);
    CHECK(std::abs(one - alone) <= 1e-12 * std::abs(one));
    const Eigen::MatrixXcd S = mimo_loop(system, {"y", "x"}).S.transfer(s),
                           T = mimo_loop(system, {"y", "x"}).T.transfer(s),
                           I = Eigen::MatrixXcd::Identity(2, 2);
    CHECK((S * (I + both) - I).norm() <= 1e-12);
    CHECK((T - (I - S)).norm() <= 1e-12);
  }
}

TEST_CASE("a chain of cuts: each return reads the next cut") {
  // e2 = cut b of 3 x, x' = -cut a of 2 b: L of a alone is 6 / s; cut both: [0 2; -3/s 0] of [a b].
  Diagram d{"chain"};
  auto u = d.input("u");
  auto x = d.add("x", Integrator{});
  const auto b = d.loop_point("b", 3.0 * x.out);
  const auto a = d.loop_point("a", 2.0 * b);
  x.in = u - a;
  d.output("y") = x.out;
  const System system = compile(d);
  for (const Complex s : kPoints) {
    CHECK(std::abs(scalar(loop(system, "a").L, s) - 6.0 / s) <= 1e-13 * std::abs(6.0 / s));
    CHECK(std::abs(scalar(loop(system, "b").L, s) - 6.0 / s) <= 1e-13 * std::abs(6.0 / s));
    const Eigen::MatrixXcd L = mimo_loop(system, {"a", "b"}).L.transfer(s);
    CHECK(std::abs(L(0, 0)) == 0);
    CHECK(std::abs(L(1, 1)) == 0);
    CHECK(std::abs(L(0, 1) + 2.0) <= 1e-13);
    CHECK(std::abs(L(1, 0) - 3.0 / s) <= 1e-13 * std::abs(3.0 / s));
  }
}

TEST_CASE("mistakes: unknown names, none, twice, no size") {
  const System system = compile(inertia(true)), bare = compile(inertia(false));
  CHECK(has_mistake(error_of([&] { loop(system, "torqe"); }), Code::unknown_name,
                    {"inertia", "torqe", "torque"}));
  CHECK(has_mistake(error_of([&] { loop(system, "hub"); }), Code::unknown_name, {"hub", "torque"}));
  CHECK(
      has_mistake(error_of([&] { loop(bare, "a"); }), Code::unknown_name, {"d.loop_point(\"a\""}));
  CHECK(has_mistake(error_of([&] { mimo_loop(system, std::vector<std::string>{}); }),
                    Code::bad_value, {"loop point"}));
  CHECK(has_mistake(error_of([&] {
                      mimo_loop(system, {"torque", "torque"});
                    }),
                    Code::duplicate_name, {"torque"}));
  Diagram wide{"wide"}, other{"other"};
  const auto x = wide.input("x", 2001);
  CHECK(has_mistake(error_of([&] { other.loop_point("p", x); }), Code::unknown_name,
                    {"another diagram"}));
  Diagram d{"nothing"};
  CHECK(has_mistake(error_of([&] { d.add("none", LoopPoint{.size = 0}); }), Code::size,
                    {"none", "LoopPoint"}));
}

TEST_CASE("a loop point in a diagram file, and in the drawing") {
  const Diagram d = inertia(true);
  const Diagram again = parse_diagram(diagram_json(d));
  CHECK(loop_points(compile(again)) == std::vector<std::string>{"torque"});
  CHECK(to_dot(d).find("torque") != std::string::npos);
}

TEST_CASE("margins carry the warnings of L, and print them") {
  // Two gains in a loop of their own, 1 - delta around: 1/delta in all. With a law of gain delta
  // and an integrator L is 1/s; of the loop's 16 digits those of delta are lost.
  for (const double delta : {0.5, std::ldexp(1, -30)}) {
    Diagram d{"amplifier"};
    auto r = d.input("r");
    auto first = d.add("first", Lti{.D = MatrixXd::Constant(1, 1, 1)});
    auto second = d.add("second", Lti{.D = MatrixXd::Constant(1, 1, 1 - delta)});
    auto x = d.add("x", Integrator{});
    first.in = r - d.loop_point("law", delta * x.out) + second.out;
    second.in = first.out;
    x.in = first.out;
    d.output("x") = x.out;
    const Margins m = margins(loop(compile(d), "law"));
    CHECK(m.stable);
    CHECK(std::abs(m.loops.at(0).phase.value - std::acos(-1.0) / 2) <= 1e-6);
    const bool lost = delta < 0.1;
    REQUIRE(m.warnings.empty() == !lost);
    const std::string text = to_string(m);
    CHECK((text.find("\nwarning of L: certify: the loop at first.in has margin ") !=
           std::string::npos) == lost);
  }
}
