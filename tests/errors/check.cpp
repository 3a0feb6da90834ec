#include <doctest/doctest.h>
#include <fmt/format.h>

#include <fstream>
#include <limits>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

// Mistakes in the description itself: the pass `check`, and mistakes refused at once. Mistakes of
// ports, frames, quantities and sizes in equations are in tests/graph.

using namespace titop;
using namespace titop_test;

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RigidBody brick() { return {.mass = 4, .children = {{"C1", {1, 0, 0}}}}; }

/// The error of adding this spec.
template <class Spec>
Error refused(const Spec& spec) {
  Diagram d{"refused"};
  return error_of([&] { d.add("X", spec); });
}

}  // namespace

TEST_CASE("an Error prints code, message, details and the way out") {
  const Error e({Mistake{Code::no_equation, "a is not driven", {"a was added at x.cpp:3"}, "do"},
                 Mistake{Code::ill_posed, "b", {}, "change b"}});
  CHECK(std::string(e.what()) ==
        "error[no-equation]: a is not driven\n  a was added at x.cpp:3\n  do\n\n"
        "error[ill-posed]: b\n  change b");
  CHECK(e.has(Code::ill_posed));
  CHECK_FALSE(e.has(Code::size));
}

TEST_CASE("the printed names of the codes are a stable interface") {
  const std::vector<std::string> names{
      "no-equation",  "two-equations",  "size",           "quantity",       "frame",
      "unknown-name", "duplicate-name", "not-finite",     "not-a-rotation", "structure",
      "ill-posed",    "improper",       "kinematic-loop", "bad-inertia",    "bad-modes",
      "bad-file",     "bad-value",      "singular",       "not-rational"};
  for (std::size_t i = 0; i < names.size(); ++i) CHECK(to_string(static_cast<Code>(i)) == names[i]);
  CHECK(to_string(static_cast<Code>(names.size())) == "unknown");  // the list is complete

  std::ifstream file(TITOP_SOURCE_DIR "/docs/errors.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  for (const std::string& name : names) {
    INFO(name, " in the table of docs/errors.md");
    CHECK(page.find("\n| `" + name + "` | ") != std::string::npos);
  }
}

TEST_CASE("no-equation: an unmounted body, one-way ports, outputs") {
  Diagram d{"scene"};
  const auto body = next_line();
  auto A = d.add("A", brick());
  const auto gain = next_line();
  auto K = d.add("K", Gain{});
  const auto output = next_line();
  d.output("y");
  d.output("k") = K.out;
  d.output("a", 6) = A.child.accel;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 3);
  CHECK(says(e, Code::no_equation,
             {body, "mount(A, B.child(\"C1\")", "A.parent.accel = 0", "A.parent.force = 0"}));
  CHECK(says(e, Code::no_equation, {gain, "K.in = 0"}));
  CHECK(says(e, Code::no_equation, {output, "d.output(\"y\") = "}));
}

TEST_CASE("no-equation: the error of a partly driven channel names the other directions") {
  Diagram d{"scene"};
  auto A = d.add("A", brick());
  A.parent.accel.linear = 0;
  A.parent.force.along({0, 1, 0}) = 0;
  Diagram half{"half"};
  auto B = half.add("B", brick());
  B.parent.accel.linear = 0;
  CHECK(says(compile_error(half), Code::no_equation, {"B.parent.accel", "3", "6"}));
  CHECK(compile_error(d).has(Code::two_equations));
}

TEST_CASE("two directions of one point that are not at right angles: which one to take instead") {
  Diagram d{"oblique"};
  auto A = d.add("A", RigidBody{});
  A.parent.accel.along({1, 0, 0}) = 0;
  A.parent.accel.along({1, 1, 0}) = 0;
  d.output("a", 6) = A.parent.accel;
  CHECK(says(compile_error(d), Code::two_equations,
             {"A.parent.accel.linear.along(1, 0, 0)", "A.parent.accel.linear.along(1, 1, 0)",
              "(0, 1, 0)"}));
}

TEST_CASE("two-equations: outputs and one-way ports") {
  Diagram d{"scene"};
  auto u = d.input("u");
  auto K = d.add("K", Gain{});
  const auto in1 = next_line();
  K.in = u;
  const auto in2 = next_line();
  K.in = 2 * u;
  const auto out1 = next_line();
  d.output("y") = K.out;
  auto z = d.output("z");
  z = u;
  const auto out2 = next_line();
  z = K.out;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 2);
  CHECK(says(e, Code::two_equations, {"K.in", in1, in2}));
  CHECK(says(e, Code::two_equations, {"z", out2}));
}

TEST_CASE("size: declarations and matrices of nodes") {
  Diagram d{"scene"};
  const auto input = next_line();
  d.input("u", 0);
  const auto output = next_line();
  d.output("y", -1) = 0;
  const Error e = compile_error(d);
  CHECK(says(e, Code::size, {"u", "0", input}));
  CHECK(says(e, Code::size, {"y", "-1", output}));
  CHECK(says(refused(Gain{.size = 0}), Code::size, {"X", "Gain", "0", "errors/check.cpp"}));
  CHECK(says(refused(Sum{.signs = ""}), Code::size, {"X", "Sum"}));
  CHECK(says(refused(MatrixGain{.matrix = {}}), Code::size, {"X", "MatrixGain"}));
  CHECK(says(refused(Integrator{.size = 0}), Code::size, {"X", "Integrator", "0"}));
  CHECK(says(refused(Lti{.A = Eigen::MatrixXd::Zero(2, 2),
                         .B = Eigen::MatrixXd::Zero(3, 1),
                         .C = Eigen::MatrixXd::Zero(1, 2)}),
             Code::size, {"X", "Lti", "2x2", "3x1", "1x2"}));
  // A forgotten A is not a gain of D.
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  CHECK(says(refused(Lti{.B = one, .C = one, .D = one}), Code::size, {"X", "Lti", "0x0", "1x1"}));
  CHECK(says(refused(Sum{.signs = "+", .size = -1}), Code::size, {"X", "Sum"}));
  CHECK(says(
      error_of([] { static_cast<void>(RigidBody{.inertia = Eigen::MatrixXd::Identity(6, 6)}); }),
      Code::size, {"inertia", "6 x 6"}));
  CHECK(says(error_of([] { static_cast<void>(RigidBody{.inertia = Eigen::MatrixXd::Ones(3, 1)}); }),
             Code::size, {"inertia", "3 x 1", "3 x 3"}));
}

TEST_CASE("size: the part of a signal that has no parts") {
  Diagram d{"scene"};
  auto z = d.add("z", SpringMass{});
  ground(z);
  const auto where = next_line();
  d.output("y", 3) = z.parent.reaction.linear();
  CHECK(says(compile_error(d), Code::size, {".linear", "1", where}));
}

TEST_CASE("unknown-name: names of a model") {
  Diagram d{"scene"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{});
  ground(z);
  z.child.force = u;
  d.output("y") = z.stretch;
  const StateSpace m = compile(d).state_space();
  CHECK(m.state("z.stretch_rate") == 1);
  CHECK(says(error_of([&] { return m.output("x"); }), Code::unknown_name, {"\"x\"", "y"}));
  CHECK(says(error_of([&] { return m.input("x"); }), Code::unknown_name, {"\"x\"", "u"}));
  CHECK(says(error_of([&] { return m.state("x"); }), Code::unknown_name, {"\"x\"", "z.stretch"}));
}

TEST_CASE("duplicate-name: nodes, inputs, outputs, parameters, points of a body") {
  Diagram d{"scene"};
  const auto first = next_line();
  auto z1 = d.add("z", SpringMass{});
  const auto second = next_line();
  auto z2 = d.add("z", SpringMass{});
  ground(z1), ground(z2);
  const auto third = next_line();
  d.input("u"), d.input("u");
  const auto fourth = next_line();
  d.output("y") = z1.stretch, d.output("y") = z2.stretch;
  const auto fifth = next_line();
  d.param("k", 1), d.param("k", 1);
  const auto sixth = next_line();
  d.input("");
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 5);
  CHECK(says(e, Code::duplicate_name, {"z", first, second}));
  CHECK(says(e, Code::duplicate_name, {"u", third}));
  CHECK(says(e, Code::duplicate_name, {"y", fourth}));
  CHECK(says(e, Code::duplicate_name, {"k", fifth}));
  CHECK(says(e, Code::duplicate_name, {sixth}));
  CHECK(says(refused(RigidBody{.children = {{"C1"}, {"C1"}}}), Code::duplicate_name,
             {"X", "\"C1\""}));
  CHECK(says(refused(RigidBody{.children = {{"parent"}}}), Code::duplicate_name,
             {"X", "\"parent\""}));
}

TEST_CASE("duplicate-name: W(3) is the third scalar of W") {
  Diagram d{"scene"};
  auto z = d.add("z", SpringMass{});
  ground(z);
  const auto vector = next_line();
  auto W = d.input("W", 3);
  const auto scalar = next_line();
  auto other = d.input("W(3)");
  d.input("W(4)"), d.input("W(1"), d.input("V(1)");
  z.child.force = other + Eigen::RowVector3d(1, 2, 3) * W;
  d.output("y(1)") = z.stretch;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 1);
  CHECK(says(e, Code::duplicate_name, {"W(3)", "W", vector, scalar}));
  Diagram out{"scene"};
  auto b = out.add("b", brick());
  b.parent.force = -out.input("W", 6);
  const auto six = next_line();
  out.output("a", 6) = b.parent.accel;
  const auto one = next_line();
  out.output("a(6)") = b.parent.about({0, 0, 1}).accel;
  CHECK(says(compile_error(out), Code::duplicate_name, {"a(6)", six, one}));
}

TEST_CASE("unknown-name: a parameter that no diagram has made") {
  struct {
    Param k, c;
  } p;
  Diagram d{"scene"};
  p.k = d.param("k", 10.0);
  CHECK(says(error_of([&] { d.add("z", SpringMass{.stiffness = p.k, .damping = p.c}); }),
             Code::unknown_name, {"d.param("}));
  auto z = d.add("z", SpringMass{.stiffness = p.k});
  CHECK(
      says(error_of([&] { z.child.force = -p.c * z.stretch; }), Code::unknown_name, {"d.param("}));
}

TEST_CASE("not-finite: parameters, gains, matrices, blocks") {
  Diagram d{"scene"};
  const auto param = next_line();
  d.param("k", kNan);
  auto z = d.add("z", SpringMass{});
  ground(z);
  const auto gain = next_line();
  d.output("y") = kInf * z.stretch;
  const auto matrix = next_line();
  d.output("m") = Eigen::MatrixXd::Constant(1, 1, kNan) * z.stretch;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 3);
  CHECK(says(e, Code::not_finite, {"k", "nan", param}));
  CHECK(says(e, Code::not_finite, {"inf", gain}));
  CHECK(says(e, Code::not_finite, {matrix}));
  CHECK(says(refused(SpringMass{.mass = kInf}), Code::not_finite, {"X", "SpringMass", "mass inf"}));
  CHECK(says(refused(RigidBody{.mass = kNan}), Code::not_finite, {"X", "mass"}));
  CHECK(says(refused(RigidBody{.PA = {kNan, 0, 0}}), Code::not_finite, {"X", "PA"}));
  CHECK(says(refused(Lti{.D = Eigen::MatrixXd::Constant(1, 1, kInf)}), Code::not_finite,
             {"X", "Lti"}));
}

TEST_CASE("not-finite: gains whose product overflows, with the line") {
  Diagram d{"scene"};
  auto z = d.add("z", SpringMass{});
  ground(z);
  const auto where = next_line();
  d.output("y") = 1e200 * (1e200 * z.stretch);
  CHECK(says(compile_error(d), Code::not_finite, {"1e+200 * 1e+200 * z.stretch", where}));
}

TEST_CASE("not-a-rotation") {
  Matrix3d sheared = Matrix3d::Identity(), mirror = Matrix3d::Identity(),
           rounded = Matrix3d::Identity();
  sheared(0, 1) = 1e-6;
  mirror(2, 2) = -1;
  rounded(0, 1) = 1e-10;
  CHECK(says(error_of([&] { Rotation::matrix(sheared); }), Code::not_a_rotation, {"1e-06"}));
  CHECK(says(error_of([&] { Rotation::matrix(mirror); }), Code::not_a_rotation, {"-1"}));
  CHECK(says(error_of([&] { Rotation::matrix(Matrix3d::Constant(kNan)); }), Code::not_a_rotation,
             {"nan"}));
  CHECK(says(error_of([&] {
               Rotation::about({0, 0, 0}, 1);
             }),
             Code::not_a_rotation, {"(0, 0, 0)"}));
  CHECK(says(error_of([&] { Rotation::about({0, 0, 1}, kInf); }), Code::not_a_rotation, {"inf"}));
  const Matrix3d T = Rotation::matrix(rounded).nominal();
  CHECK((T.transpose() * T - Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 1e-15);
}

TEST_CASE("bad-inertia") {
  CHECK(says(refused(SpringMass{.mass = -1}), Code::bad_inertia, {"X", "SpringMass", "mass -1"}));
  CHECK(says(refused(SpringMass{.parent_mass = -1}), Code::bad_inertia,
             {"X", "SpringMass", "parent_mass -1"}));
  CHECK(says(refused(RigidBody{.mass = -2}), Code::bad_inertia, {"X", "mass", "-2"}));
  CHECK(says(refused(RigidBody{.inertia = Vector3d(1, 1, 3).asDiagonal()}), Code::bad_inertia,
             {"X", "1", "3", "errors/check.cpp"}));
  CHECK(says(refused(RigidBody{.inertia = Vector3d(1, 1, -0.5).asDiagonal()}), Code::bad_inertia,
             {"X", "inertia", "-0.5"}));
  Matrix3d skew = Matrix3d::Identity();
  skew(0, 1) = 0.1;
  CHECK(says(refused(RigidBody{.inertia = skew}), Code::bad_inertia, {"X", "inertia", "0.1"}));
}

TEST_CASE("bad-modes") {
  ModalData data;
  data.omega = Eigen::Vector2d(3, 7);
  data.xi = Eigen::Vector2d(0.01, 0.01);
  data.L_P = Eigen::MatrixXd::Zero(2, 6);
  data.L_P(0, 1) = 2;
  data.D_P = rigid_mass(5, Matrix3d::Identity(), Vector3d::Zero());
  CHECK(error_of([&] { FlexibleBody{data}; }).mistakes().empty());
  ModalData heavy = data, short_of = data, still = data, child = data;
  heavy.L_P(0, 1) = 3;
  short_of.xi.resize(1);
  still.omega(1) = 0;
  child.children.push_back({"C1", {0, 0, 0}, Eigen::MatrixXd::Zero(6, 3)});
  CHECK(says(error_of([&] { FlexibleBody{heavy}; }), Code::bad_modes, {"D_P - L_P' L_P", "y"}));
  CHECK(says(error_of([&] { FlexibleBody{short_of}; }), Code::bad_modes, {"xi", "1 x 1", "2"}));
  CHECK(says(error_of([&] { FlexibleBody{still}; }), Code::bad_modes, {"mode 2", "omega 0"}));
  CHECK(says(error_of([&] { FlexibleBody{child}; }), Code::bad_modes,
             {"Phi_C", "C1", "6 x 3", "6 x 2"}));
}

TEST_CASE("bad-value: options") {
  Diagram d{"scene"};
  ground(d.add("z", SpringMass{}));
  const auto refused_with = [&](const Options& options) {
    return error_of([&] { compile(d, options); });
  };
  CHECK(refused_with({.minimize_up_to = 0, .resolution = 0.5}).mistakes().empty());
  for (const double resolution : {10.0, 1.0, -1.0, std::nan("")})
    CHECK(says(refused_with({.resolution = resolution}), Code::bad_value,
               {"Options::resolution", fmt::format("{}", resolution)}));
  CHECK(says(refused_with({.minimize_up_to = -5}), Code::bad_value,
             {"Options::minimize_up_to", "-5"}));
  CHECK(says(refused_with({.exact_up_to = -1}), Code::bad_value, {"Options::exact_up_to", "-1"}));
}

TEST_CASE("duplicate-name: a parameter set twice by update") {
  Diagram d{"scene"};
  auto z = d.add("z", SpringMass{.stiffness = d.param("k", 2)});
  ground(z);
  z.child.force = d.input("u");
  d.output("x") = z.stretch;
  const System system = compile(d);
  CHECK(says(error_of([&] {
               system.update({{"k", 3}, {"k", 4}});
             }),
             Code::duplicate_name, {"k", "4"}));
}

TEST_CASE("duplicate-name: frames of two nodes of one name are not told apart") {
  Diagram d{"scene"};
  auto A = d.add("hub", brick()), B = d.add("hub", brick());
  release(A);
  mount(B, A.child, Rotation::about({0, 0, 1}, 0.3).named("hub", "hub"));
  A.child.force += B.parent.force;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 1);
  CHECK(says(e, Code::duplicate_name, {"hub"}));
}

TEST_CASE("bad-value") {
  CHECK(says(refused(SpringMass{.stiffness = -3}), Code::bad_value,
             {"X", "SpringMass", "stiffness -3"}));
  CHECK(
      says(refused(SpringMass{.damping = -3}), Code::bad_value, {"X", "SpringMass", "damping -3"}));
  CHECK(says(refused(Sum{.signs = "+*"}), Code::bad_value, {"X", "Sum", "'*'"}));
  CHECK(says(error_of([] { FlexibleBody{Beam{}}; }), Code::bad_value, {"length", "0"}));
  CHECK(says(error_of([] { rectangle(-1, 1); }), Code::bad_value, {"width", "-1"}));
  CHECK(says(error_of([] { tube(1, 2); }), Code::bad_value, {"1", "2", "tube(outer, inner)"}));
  CHECK(says(refused(Hinge{.axis = {0, 0, 0}}), Code::bad_value, {"X", "axis", "(0, 0, 0)"}));
  Diagram d{"scene"};
  auto A = d.add("A", brick());
  CHECK(says(error_of([&] {
               A.parent.accel.along({0, 0, 0});
             }),
             Code::bad_value, {"A.parent.accel.linear.along(0, 0, 0)"}));
}

TEST_CASE("all mistakes of the description come together, in one text") {
  Diagram d{"five likely mistakes"};
  auto u = d.input("u", 3);
  auto B = d.add("B", brick());
  auto A = d.add("A", brick());  // unmounted
  auto z = d.add("z", SpringMass{});
  B.parent.force = u;              // size
  B.child.force = A.parent.force;  // frame
  z.parent.accel = 0;
  z.child.force = z.parent.force;
  z.child.force = 0;                          // twice
  d.output("x") = z.stretch + z.child.accel;  // quantity
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 5);
  for (const Code code :
       {Code::size, Code::frame, Code::no_equation, Code::two_equations, Code::quantity}) {
    CHECK(e.has(code));
    CHECK(std::string(e.what()).find("error[" + std::string(to_string(code)) + "]: ") !=
          std::string::npos);
  }
}
