#include <doctest/doctest.h>

#include <numbers>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"

// Mistakes that are detected from all equations together, or from their numbers.

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;

namespace {

RigidBody brick(double mass = 4) {
  return {.mass = mass, .inertia = mass * Matrix3d::Identity(), .children = {{"C1", {1, 0, 0}}}};
}

/// A spring-mass under the force k * (its own acceleration) + u: alone it would need m a = k a + u.
Diagram loop(double mass, double gain) {
  Diagram d{"loop"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = mass, .stiffness = 26});
  auto K = d.add("K", Lti{.D = Eigen::MatrixXd::Constant(1, 1, gain)});
  ground(z);
  K.in = z.child.accel;
  z.child.force = u + K.out;
  d.output("a_z") = z.child.accel;
  return d;
}

}  // namespace

TEST_CASE("structure: driven everywhere and still determined twice") {
  Diagram d{"rigid"};
  auto u = d.input("u", 6), v = d.input("v", 6);
  auto A = d.add("A", brick());
  const auto first = next_line();
  A.parent.accel = u;
  const auto second = next_line();
  A.child.accel = v;
  d.output("f", 6) = A.child.force;
  const Error e = compile_error(d);
  CHECK(says(e, Code::structure, {"A.child(\"C1\").force", first, second}));
}

TEST_CASE("ill-posed: a loop of gains that cancels") {
  Diagram d{"gains"};
  auto u = d.input("u");
  auto g1 = d.add("g1", Gain{.gain = 0.5}), g2 = d.add("g2", Gain{.gain = 2});
  g1.in = g2.out + u;
  g2.in = g1.out;
  d.output("y") = g2.out;
  CHECK(says(compile_error(d), Code::ill_posed, {"g1.", "g2."}));
}

TEST_CASE("improper: a feedthrough that cancels the mass, at any unit") {
  for (const double unit : {1.0, 1e9, 1e-9, 1e150, 1e-150}) {
    CAPTURE(unit);
    CHECK(says(compile_error(loop(2 * unit, 2 * unit)), Code::improper,
               {"u", "a_z", "2", "K.out = ", "z.child.force = "}));
    const Complex s(0.2, 1.3);
    const Complex exact = s * s / ((2 - 1.5) * unit * s * s + 26.0);
    CHECK(relative(compile(loop(2 * unit, 1.5 * unit)).transfer(s)(0, 0), exact) <= 1e-14);
  }
}

TEST_CASE("improper: a force on a massless point") {
  Diagram d{"massless"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{});
  const auto where = next_line();
  z.parent.force = -u;
  d.output("a_z") = z.parent.accel;
  CHECK(says(compile_error(d), Code::improper,
             {"u", "a_z", "2", "z.parent.force = ", where, "0", "SpringMass{.parent_mass = ...}"}));
}

TEST_CASE("improper: a massless body set free; a point that the modes cannot move, locked") {
  Diagram d{"massless"};
  auto u = d.input("u", 6);
  auto A = d.add("A", brick(0));
  A.parent.force = -u;
  d.output("a", 6) = A.parent.accel;
  CHECK(says(compile_error(d), Code::improper,
             {"A.parent.force", "A", "0", "RigidBody{.mass = ...}"}));

  ModalData data;
  data.omega = Eigen::VectorXd::Constant(1, 3.0);
  data.xi = Eigen::VectorXd::Constant(1, 0.01);
  data.L_P = Eigen::MatrixXd::Zero(1, 6);
  data.D_P = rigid_mass(5, Matrix3d::Identity(), Vector3d::Zero());
  data.children.push_back({"C1", {1, 0, 0}, Eigen::MatrixXd::Identity(6, 1)});
  Diagram locked{"locked"};
  auto v = locked.input("v", 6);
  auto B = locked.add("B", FlexibleBody(data));
  B.parent.force = 0;
  B.child.accel = v;
  locked.output("f", 6) = B.child.force;
  CHECK(error_of([&] { compile(locked); }).mistakes().empty());  // free: it follows rigidly
  Diagram both{"both"};
  auto w = both.input("w", 6);
  auto C = both.add("C", FlexibleBody(data));
  C.parent.accel = w;
  C.child.accel = w;
  both.output("f", 6) = C.child.force;
  CHECK(says(compile_error(both), Code::improper, {"C.child(\"C1\").accel", "C1", "rank 1", "6"}));
}

TEST_CASE("improper: at a hinge, the body without inertia is told from the one that has it") {
  const auto scene = [](double hub_mass, double arm_mass, bool read) {
    Diagram d{"hinged"};
    auto U = d.input("U", 6);
    auto B = d.add("B", brick(hub_mass)), A = d.add("A", brick(arm_mass));
    B.parent.force = -U;
    auto h = hinge(d, "h", A, B.child, Rotation{}, {0, 0, 1});
    h.torque = 0;
    d.output("a", 6) = B.parent.accel;
    if (read) d.output("tip", 6) = A.child.accel;
    return d;
  };
  CHECK(compile_error(scene(4, 2, true)).mistakes().empty());
  CHECK(compile_error(scene(4, 0, false)).mistakes().empty());  // the arm's rotation is not read
  CHECK(says(compile_error(scene(4, 0, true)), Code::improper,
             {"h.torque", "A.parent", "z", "tip(2)", "tip(6)"}));
  CHECK(says(compile_error(scene(0, 0, false)), Code::improper,
             {"B.parent.force", "B", "0", "RigidBody{.mass = ...}"}));
}

TEST_CASE("kinematic-loop: a chain that does not meet, by how much and along which points") {
  Diagram f{"free"};
  auto C = f.add("C", brick()), D = f.add("D", brick());
  C.parent.force = 0;
  mount(D, C.child, Rotation::about({0, 0, 1}, std::numbers::pi + 1e-3));
  const auto joint = next_line();
  D.child.accel = Rotation::about({0, 0, 1}, std::numbers::pi) * C.parent.accel;
  const Error g = compile_error(f);
  CHECK(
      says(g, Code::kinematic_loop,
           {"D.child(\"C1\").accel", "1.0e-03", joint, "C.parent", "C.child(\"C1\")", "D.parent"}));
}

constexpr Precision kPrecisions[] = {Precision::standard, Precision::refined, Precision::twofold,
                                     Precision::digits50};

TEST_CASE("singular: at a pole") {
  Diagram d{"pole"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 0});
  ground(z);
  z.child.force = u;
  d.output("x") = z.stretch;
  const System system = compile(d);
  CHECK(says(error_of([&] { return system.static_gain(); }), Code::singular, {"s = 0"}));
  CHECK(
      says(error_of([&] { return system.state_space().transfer(0); }), Code::singular, {"s = 0"}));
  CHECK(says(error_of([&] { return transfer(d.graph(), 0); }), Code::singular, {"s = 0"}));
  for (const Precision p : kPrecisions) {
    CAPTURE(static_cast<int>(p));
    CHECK(says(error_of([&] { return system.transfer(0, p); }), Code::singular, {"s = 0"}));
  }
}

TEST_CASE("singular: at a pole of a block without modes, in any precision") {
  Diagram d{"pole"};
  auto K = d.add("K", Lti{.A = Eigen::MatrixXd{{-2, 1}, {0, -3}},
                          .B = Eigen::MatrixXd{{0}, {1}},
                          .C = Eigen::MatrixXd{{1, 0}}});
  K.in = d.input("u");
  d.output("y") = K.out;
  const System system = compile(d);
  for (const Precision p : kPrecisions) {
    CAPTURE(static_cast<int>(p));
    CHECK(says(error_of([&] { return system.transfer(-3, p); }), Code::singular, {"s = -3"}));
    CHECK(std::abs(system.transfer(-1, p)(0, 0) - 0.5) <= 1e-6);  // 1 / ((s + 2) (s + 3))
  }
}

TEST_CASE("transfer of a graph that compile would refuse: refused, too") {
  const auto refusal = [](auto write) {
    Diagram d{"wrong"};
    auto u = d.input("u");
    write(d, u);
    return error_of([&] { return transfer(d.graph(), 1.0); });
  };
  CHECK(says(refusal([](Diagram& d, const InputRef& u) {
               auto g = d.add("g", Gain{.gain = 1});
               g.in = u;
               g.in = u;
               d.output("y") = g.out;
             }),
             Code::two_equations, {"wrong", "2"}));
  CHECK(says(refusal([](Diagram& d, const InputRef& u) {
               auto body = d.add("b", RigidBody{.mass = 1, .inertia = Matrix3d::Identity()});
               ground(body);
               ground(body);
               d.output("y", 6) = body.parent.force;
               d.output("z") = u;
             }),
             Code::two_equations, {"wrong"}));
  CHECK(says(refusal([](Diagram& d, const InputRef& u) {
               auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 3});
               ground(z);
               z.child.force = u;
               d.output("y", 3) = z.stretch;
             }),
             Code::size, {"z.stretch"}));
}

TEST_CASE("no false alarm: chains without loops, whatever their gains") {
  for (const double gain : {1e8, 1e50, 1e150, 1e-150}) {
    CAPTURE(gain);
    Diagram d{"chain"};
    auto u = d.input("u");
    auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 3});
    auto g1 = d.add("g1", Gain{.gain = gain}), g2 = d.add("g2", Gain{.gain = -1 / gain});
    auto K = d.add("K", Lti{.D = Eigen::MatrixXd::Constant(1, 1, gain)});
    auto y = d.add("y", SpringMass{.mass = 2, .stiffness = 5});
    g1.in = u;
    K.in = g1.out;
    g2.in = K.out;
    ground(z), ground(y);
    z.child.force = g2.out;
    y.child.force = gain * z.child.accel;
    d.output("x") = y.stretch;
    d.output("k") = K.out;
    const System system = compile(d);
    CHECK(system.certificate().margin == 1);
    const Complex s(0.2, 1.3);
    const Complex a = s * s / (s * s + 3.0), exact = -gain * gain * a / (2.0 * s * s + 5.0);
    CHECK(relative(system.transfer(s)(0, 0), exact) <= 1e-14);
    CHECK(relative(system.transfer(s)(1, 0), Complex(gain * gain)) <= 1e-15);
    CHECK(relative(system.state_space().transfer(s)(0, 0), exact) <= 1e-13);
  }
}

TEST_CASE("no false alarm: bodies of very different mass, and any unit") {
  for (const double unit : {1.0, 1e9, 1e-9})
    for (const double ratio : {1.0, 1e-12, 1e12}) {
      CAPTURE(unit);
      CAPTURE(ratio);
      Diagram d{"masses"};
      auto u = d.input("u", 6);
      auto B = d.add("B", brick(unit)), A = d.add("A", brick(unit * ratio));
      B.parent.force = -u;
      mount(A, B.child, Rotation::about({1, 1, 0}, 0.3));
      d.output("a", 6) = B.parent.accel;
      const System system = compile(d);
      // Static gain: inverse of the total mass about P; the second body acts at C1.
      Eigen::MatrixXd T = Eigen::MatrixXd::Zero(6, 6);
      T.topLeftCorner<3, 3>() = T.bottomRightCorner<3, 3>() =
          Rotation::about({1, 1, 0}, 0.3).nominal();
      const Matrix6 Y = T.transpose() * tau({-1, 0, 0});
      const Matrix6 one = rigid_mass(unit, unit * Matrix3d::Identity(), Vector3d::Zero());
      const Matrix6 exact = Matrix6(one + ratio * Y.transpose() * one * Y).inverse();
      CHECK(matrix_error(system.static_gain(), exact) <= 1e-12);
    }
}

TEST_CASE("bad-file: a folder for the drawings that cannot be made") {
  Diagram d{"drawn"};
  auto z = d.add("z", SpringMass{});
  ground(z);
  d.output("x") = z.stretch;
  const Error error = titop_test::error_of([&] { compile(d, {.dump_to = "/dev/null/passes"}); });
  CHECK(titop_test::says(error, Code::bad_file, {"/dev/null/passes/00-diagram.dot", "dump_to"}));
}
