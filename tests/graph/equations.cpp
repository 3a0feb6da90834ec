#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

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

/// A mass of 4 kg with its centre at (1, 2, 0) m from P.
RigidBody brick() {
  return {.mass = 4,
          .inertia = Vector3d(1, 2, 2.5).asDiagonal(),
          .PA = {1, 2, 0},
          .children = {{"C1", {1, 0, 0}}, {"C2", {0, 1, 0}}}};
}

StateSpace model(const Diagram& d) { return compile(d).state_space(); }

}  // namespace

TEST_CASE("a second `=` on a port is an error, with both lines") {
  Diagram d{"twice"};
  auto u = d.input("u");
  auto z = d.add("z", spring());
  z.parent.accel = 0;
  const auto first = next_line();
  z.child.force = u;
  const auto second = next_line();
  z.child.force = -u;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 1);
  CHECK(says(e, Code::two_equations, {"z.child.force", first, second, "+="}));
}

TEST_CASE("a multiple of a parameter is multiplied, divided and negated like a number") {
  Diagram d{"multiples"};
  const Param p = d.param("p", 4);
  const Value v = -(2 * p) * 3 / 8.0;
  const std::vector<double> five{5};
  CHECK((v.is_parameter() && v.scale() == -0.75 && v.nominal() == -3 && v.at(five) == -3.75));
  CHECK((-Value(2) * 3 / 4.0).nominal() == -1.5);
  CHECK((0.5 * Value(p)).at(five) == 2.5);
}

TEST_CASE("an acceleration driven twice: the error suggests weld, which closes a chain") {
  Diagram d{"held twice"};
  auto base = d.add("base", RigidBody{.children = {{"C1"}, {"C2", {1, 0, 0}}}});
  ground(base);
  const Vector3d z(0, 0, 1);
  auto bar = d.add("bar", RigidBody{.mass = 2, .children = {{"C", {1, 0, 0}}}});
  auto end = d.add("end", Hinge{z});
  mount(bar, base.child("C1"));
  mount(end, bar.child);
  const auto first = next_line();
  weld(end.child, base.child("C2"));
  const auto second = next_line();
  weld(end.child, base.child("C1"));
  end.torque = 0;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 1);
  CHECK(says(e, Code::two_equations, {first, second, "weld(point, end.child)"}));
  CHECK_FALSE(has_mistake(e, Code::two_equations, {"+="}));
}

TEST_CASE("`+=` adds to a force, before or after `=`, and `-=` takes away") {
  const auto scene = [](int way) {
    Diagram d{"sums"};
    auto u = d.input("u"), v = d.input("v"), w = d.input("w");
    auto z = d.add("z", spring());
    z.parent.accel = 0;
    if (way == 0) z.child.force = u + v - w;
    if (way == 1) z.child.force = u, z.child.force += v, z.child.force -= w;
    if (way == 2) z.child.force += v, z.child.force -= w, z.child.force = u;
    if (way == 3) z.child.force -= w, z.child.force += u, z.child.force += v;
    d.output("x") = z.stretch;
    return model(d);
  };
  for (int way = 1; way < 4; ++way) CHECK(difference(scene(way), scene(0)) == "");
  const Eigen::MatrixXcd G = scene(0).transfer(kS);
  const Complex exact = 1.0 / (2.0 * kS * kS + 26.0);
  CHECK(relative(G(0, 0), exact) <= 1e-14);
  CHECK(relative(G(0, 1), exact) <= 1e-14);
  CHECK(relative(G(0, 2), -exact) <= 1e-14);
}

TEST_CASE("a child point without an equation carries nothing") {
  Diagram d{"free end"};
  auto a = d.input("a");
  auto z = d.add("z", spring());
  z.parent.accel = a;
  d.output("f") = z.parent.force;
  d.output("end") = z.child.force;
  const Eigen::MatrixXcd G = model(d).transfer(kS);
  CHECK(relative(G(0, 0), -26.0 * 2.0 * kS * kS / (2.0 * kS * kS + 26.0) / (kS * kS)) <= 1e-14);
  CHECK(std::abs(G(1, 0)) == 0);
}

TEST_CASE("a parent point without an equation is an error; so are both sides by `=`") {
  Diagram d{"neither, both"};
  auto u = d.input("u");
  auto added = next_line();
  auto z1 = d.add("z1", spring());
  auto z2 = d.add("z2", spring());
  z2.parent.accel = 0;
  z2.parent.force = u;
  z1.child.accel = 0;
  z1.child.force = u;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 3);
  CHECK(says(e, Code::no_equation, {added, "z1.parent.accel = 0"}));
  CHECK(says(e, Code::two_equations, {"z2.parent.accel = 0", "z2.parent.force = u"}));
  CHECK(says(e, Code::two_equations, {"z1.child.accel = 0", "z1.child.force = u"}));
}

TEST_CASE("`+=` alone releases a parent point") {
  Diagram d{"released"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 26, .parent_mass = 3});
  release(z);
  z.child.force = u;
  d.output("a") = 2 * z.child.accel + 3 * z.parent.accel;  // momentum balance
  CHECK(relative(model(d).transfer(kS)(0, 0), Complex(1)) <= 1e-14);
}

TEST_CASE("where the motion is imposed, `+=` stays in the sum of forces: reaction") {
  Diagram d{"locked"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 5, .stiffness = 500, .parent_mass = 1});
  auto z2 = d.add("z2", spring());
  release(z1);
  z1.child.accel = 0;
  mount(z2, z1.child);
  z2.child.force = u;
  d.output("total") = z1.child.force;
  d.output("support") = z1.child.reaction;
  const Eigen::MatrixXcd G = compile(d).transfer(kS);
  // z1 does not move: the support takes the force of z2, k / (m s^2 + k).
  CHECK(std::abs(G(0, 0)) <= 1e-16);
  CHECK(relative(G(1, 0), -26.0 / (2.0 * kS * kS + 26.0)) <= 1e-14);
}

TEST_CASE("a pin: no linear acceleration, no torque but the given one") {
  Diagram d{"pendulum"};
  auto t = d.input("t", 3);
  auto b = d.add("b", brick());
  b.parent.accel.linear = 0;
  b.parent.force.angular = -t;
  d.output("alpha", 3) = b.parent.accel.angular;
  d.output("pin", 3) = b.parent.force.linear;
  const Eigen::MatrixXd G = compile(d).static_gain();
  // Inertia about P: I_A + m (|a|^2 I - a a').
  const Vector3d a(1, 2, 0);
  const Matrix3d J = Matrix3d(Vector3d(1, 2, 2.5).asDiagonal()) +
                     4 * (a.squaredNorm() * Matrix3d::Identity() - a * a.transpose());
  const Matrix3d alpha = J.inverse();
  CHECK(matrix_error(G.topRows(3), alpha) <= 1e-14);
  Matrix3d pin;  // - m alpha x a
  for (int i = 0; i < 3; ++i) pin.col(i) = -4 * alpha.col(i).cross(a);
  CHECK(matrix_error(G.bottomRows(3), pin) <= 1e-14);
}

TEST_CASE("along(r): an oblique slider, the rest of the channel locked") {
  Diagram d{"slider"};
  auto f = d.input("f");
  auto b = d.add("b", brick());
  b.parent.accel.angular = 0;
  b.parent.accel.along({4, -3, 0}) = 0;  // any length
  b.parent.accel.linear.along({0, 0, 2}) = 0;
  b.parent.force.along({3, 4, 0}) = -f;
  d.output("along") = b.parent.accel.along({3, 4, 0});
  d.output("a", 3) = b.parent.accel.linear;
  d.output("torque", 3) = b.parent.force.angular;
  const Eigen::MatrixXd G = compile(d).static_gain();
  CHECK(relative(G(0, 0), 0.25) <= 1e-15);
  CHECK(relative(G(1, 0), 0.15) <= 1e-15);
  CHECK(relative(G(2, 0), 0.2) <= 1e-15);
  CHECK(std::abs(G(3, 0)) <= 1e-16);
  // Torque of the body on its parent: - PA x m a = -((1, 2, 0) x (0.6, 0.8, 0)) = 0.4 z.
  CHECK(std::abs(G(4, 0)) <= 1e-16);
  CHECK(std::abs(G(5, 0)) <= 1e-16);
  CHECK(relative(G(6, 0), 0.4) <= 1e-14);
}

TEST_CASE("two parts that overlap are an error") {
  Diagram d{"overlap"};
  auto b = d.add("b", brick());
  b.parent.accel.linear = 0;
  b.parent.force.along({0, 1, 0}) = 0;
  b.parent.accel.angular = 0;
  CHECK(says(compile_error(d), Code::two_equations, {"b.parent.accel", "b.parent.force"}));
}

TEST_CASE("`= 0` is an equation of ports, one-way ports and outputs") {
  Diagram d{"zeros"};
  auto K = d.add("K", Gain{.gain = 3});
  auto z = d.add("z", spring());
  z.parent.accel = 0;
  z.child.force = 0;
  z.child.force += 0;
  K.in = 0;
  d.output("nothing") = 0;
  d.output("x") = z.stretch;
  const StateSpace m = model(d);
  CHECK(m.order() == 2);
  CHECK(m.C.row(0).isZero(0));
  CHECK(m.D.size() == 0);
}

TEST_CASE("a port set to a port is an equation, not a copy") {
  Diagram d{"equation"};
  auto z1 = d.add("z1", spring());
  auto z2 = d.add("z2", spring());
  z2.parent.accel = z1.child.accel;
  const auto& tip = z1;  // a const handle writes equations as well
  tip.child.force = z2.parent.force;
  REQUIRE(d.graph().equations.size() == 2);
  CHECK(print(d.graph(), d.graph().equations[0]) == "z2.parent.accel = z1.child.accel");
  CHECK(print(d.graph(), d.graph().equations[1]) == "z1.child.force = z2.parent.force");
}

TEST_CASE("a handle rebinds like a name and writes no equation") {
  Diagram d{"names"};
  auto z1 = d.add("z1", spring()), z2 = d.add("z2", spring());
  auto b1 = d.add("b1", brick()), b2 = d.add("b2", brick());
  auto K1 = d.add("K1", Lti{.D = Eigen::MatrixXd::Ones(1, 1)});
  auto K2 = d.add("K2", Lti{.D = Eigen::MatrixXd::Ones(1, 1)});
  auto g1 = d.add("g1", Gain{}), g2 = d.add("g2", Gain{});
  auto s1 = d.add("s1", Sum{}), s2 = d.add("s2", Sum{});
  auto h1 = d.add("h1", Hinge{}), h2 = d.add("h2", Hinge{});
  z1 = z2, b1 = b2, K1 = K2, g1 = g2, s1 = s2, h1 = h2;
  auto& self = z1;
  z1 = self;
  CHECK(d.graph().equations.empty());
  z1.parent.accel = z1.stretch;
  b1.parent.force.angular = 0;
  b1.child("C2").force = 0;
  K1.in = g1.out;
  g1.in = 0;
  s1.in(1) = 0;
  h1.torque = h1.child.force.linear.along({1, 0, 0});
  std::vector<std::string> text;
  for (const Equation& e : d.graph().equations) text.push_back(print(d.graph(), e));
  CHECK(text ==
        std::vector<std::string>{"z2.parent.accel = z2.stretch", "b2.parent.force.angular = 0",
                                 "b2.child(\"C2\").force = 0", "K2.in = g2.out", "g2.in = 0",
                                 "s2.in1 = 0", "h2.torque = h2.child.force.linear.along(1, 0, 0)"});
}

TEST_CASE("child(name) works on every block; .child where there is just one") {
  Diagram d{"children"};
  auto z = d.add("z", spring());
  auto b = d.add("b", brick());
  auto h = d.add("h", Hinge{});
  z.child("child").force = 0;
  b.child("C1").force = 0;
  h.child("child").force = 0;
  REQUIRE(d.graph().equations.size() == 3);
  CHECK(name_of(d.graph(), d.graph().equations[0].target) == "z.child.force");
  CHECK(name_of(d.graph(), d.graph().equations[1].target) == "b.child(\"C1\").force");
  CHECK(name_of(d.graph(), d.graph().equations[2].target) == "h.child.force");
  CHECK(d.graph().mistakes.empty());

  const auto c3 = next_line();
  b.child("C3").force = 0;
  b.child("parent").force = 0;  // it is no child point
  const auto written = next_line();
  b.child.force = 0;  // there are two
  const auto mounted = next_line();
  mount(h, b.child);  // mentions it twice
  auto a = d.add("a", RigidBody{});
  const auto read = next_line();
  d.output("none", 1) = a.child.accel.linear.along({1, 0, 0});
  ground(a);
  const auto c4 = next_line();
  d.output("c4", 1) = b.child("C4").accel.along({1, 0, 0});
  ground(z), ground(b), h.torque = 0;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 6);
  CHECK(says(e, Code::unknown_name, {"b", "\"C3\"", c3, "C1, C2"}));
  CHECK(says(e, Code::unknown_name, {"b", "\"parent\"", "C1, C2"}));
  for (const auto& line : {written, mounted})
    CHECK(says(e, Code::unknown_name, {"b.child", line, "C1, C2"}));
  CHECK(says(e, Code::unknown_name, {"a.child", read}));
  CHECK(says(e, Code::unknown_name, {"b", "\"C4\"", c4, "C1, C2"}));
  CHECK(error_of([&] { transfer(d.graph(), kS); }).mistakes().size() == 6);
  CHECK(to_dot(d).find("a.child") == std::string::npos);  // drawn without it
}

TEST_CASE("source lines are the user's, also through mount, ground, release and hinge") {
  Diagram d{"lines"};
  auto b1 = d.add("b1", brick()), b2 = d.add("b2", brick()), b3 = d.add("b3", brick());
  const auto at_mount = next_line();
  mount(b2, b1.child("C1"));
  const auto at_port = next_line();
  b2.parent.accel = b1.child("C2").accel;
  const auto at_ground = next_line();
  ground(b1);
  b1.parent.accel = 0;
  const auto at_hinge = next_line();
  auto h = hinge(d, "h", b3, b1.child("C2"), Rotation{}, {0, 0, 1});
  const auto at_force = next_line();
  h.torque = 0;
  h.torque = 0;
  const Error e = compile_error(d);
  CHECK(says(e, Code::two_equations,
             {"b2.parent.accel", at_mount, at_port, "weld(b2.child(\"C\"), site)"}));
  CHECK_FALSE(has_mistake(e, Code::two_equations, {"b2.parent.accel", "+="}));
  CHECK(says(e, Code::two_equations, {"b1.parent.accel", at_ground}));
  CHECK(says(e, Code::two_equations, {"h.torque", at_force}));
  for (const Equation& q : d.graph().equations)
    CHECK(to_string(q.where).starts_with("graph/equations.cpp:"));
  CHECK(to_string(d.graph().nodes.back().where) == at_hinge);
}

TEST_CASE("a thousand outputs of one mass: the equations as written give each, and a certificate") {
  Diagram d{"many outputs"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 8});
  ground(z);
  z.child.force = d.input("u");
  for (int i = 0; i < 1000; ++i) d.output("y" + std::to_string(i)) = (1.0 + i) * z.stretch;
  const std::complex<double> s(0.1, 1.5);
  const Eigen::MatrixXcd H = transfer(d.graph(), s);
  REQUIRE(H.rows() == 1000);
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::complex<double> right = (1.0 + i) / (2.0 * s * s + 8.0);
    worst = std::max(worst, std::abs(H(i, 0) - right) / std::abs(right));
  }
  CHECK(worst <= 1e-14);
  CHECK(certify(compile(d)).holds());
}
