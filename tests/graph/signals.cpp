#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;

namespace {

const Complex kS(0.3, 1.7);

RigidBody brick(std::vector<ChildPoint> children = {{"C1", {1, 0, 0}}}) {
  return {.mass = 4,
          .inertia = Vector3d(1, 2, 2.5).asDiagonal(),
          .PA = {1, 2, 0},
          .children = std::move(children)};
}

SpringMass spring() { return SpringMass{.mass = 2, .stiffness = 26}; }

int unchecked(const System& system) {
  int count = 0;
  for (const Note& n : system.notes()) count += n.kind == Note::Kind::unchecked;
  return count;
}

/// A hub with an appendage whose equations are typed by hand, with this rotation.
Diagram by_hand(const Rotation& T_ba) {
  Diagram d{"by hand"};
  auto U = d.input("U", 6);
  auto B = d.add("B", brick());
  auto A = d.add("A", brick());
  B.parent.force = -U;
  A.parent.accel = T_ba.inverse() * B.child.accel;
  B.child.force = T_ba * A.parent.force;
  d.output("a", 6) = A.parent.accel;
  return d;
}

const Rotation kTurn = Rotation::about({1, 2, 3}, 0.7);

}  // namespace

TEST_CASE("frames: mount, named and nameless rotations give one model; nameless is listed") {
  Diagram d{"mounted"};
  auto U = d.input("U", 6);
  auto B = d.add("B", brick());
  auto A = d.add("A", brick());
  B.parent.force = -U;
  mount(A, B.child("C1"), kTurn);
  d.output("a", 6) = A.parent.accel;
  const System mounted = compile(d), named = compile(by_hand(kTurn.named("B", "A"))),
               nameless = compile(by_hand(kTurn));
  CHECK(unchecked(mounted) == 0);
  CHECK(unchecked(named) == 0);
  CHECK(unchecked(nameless) == 2);
  CHECK(noted(nameless, Note::Kind::unchecked, "check",
              {"B.child(\"C1\").force", "T * A.parent.force"}));
  const Eigen::MatrixXcd G = mounted.transfer(kS);
  CHECK(matrix_error(named.transfer(kS), G) <= 1e-15);
  CHECK(matrix_error(nameless.transfer(kS), G) <= 1e-15);
  // The equations as written, solved by hand: two rigid bodies are one.
  const Eigen::MatrixXd T = [] {
    Eigen::MatrixXd both = Eigen::MatrixXd::Zero(6, 6);
    both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = kTurn.nominal();
    return both;
  }();
  const Matrix6 D = rigid_mass(4, Vector3d(1, 2, 2.5).asDiagonal(), {-1, -2, 0});
  const Matrix6 Y = T.transpose() * tau({-1, 0, 0});
  const Matrix6 exact = Y * Matrix6(D + Y.transpose() * D * Y).inverse();
  CHECK(matrix_error(G.real(), exact) <= 1e-13);
  CHECK(G.imag().isZero(0));
}

TEST_CASE("frames: the identity between two bodies takes the names of their frames") {
  Diagram d{"mounted"};
  auto B = d.add("B", brick()), A = d.add("A", brick());
  B.parent.force = -d.input("U", 6);
  mount(A, B.child);
  d.output("a", 6) = A.parent.accel;
  const Diagram typed = by_hand(Rotation());
  const System system = compile(typed);
  CHECK(unchecked(system) == 0);
  CHECK(matrix_error(system.transfer(kS), compile(d).transfer(kS)) <= 1e-15);
  for (const Equation& e : typed.graph().equations)
    for (const Factor& f : e.terms.front().factors) {
      const auto& T = std::get<Rotation>(f);
      const bool motion = name_of(typed.graph(), e.target) == "A.parent.accel";
      CHECK((T.to() == (motion ? "A" : "B") && T.from() == (motion ? "B" : "A")));
    }
  d.output("difference", 6) = A.parent.accel - Rotation() * B.child.accel;
  CHECK(compile(d).transfer(kS).bottomRows(6).isZero(1e-15));
  // Names are names of frames, of the identity too.
  CHECK(compile_error(by_hand(Rotation().named("A", "B"))).has(Code::frame));
}

TEST_CASE("frames: a named rotation the wrong way round is refused") {
  const Error e = compile_error(by_hand(kTurn.named("A", "B")));
  CHECK(e.mistakes().size() == 2);  // on two lines
  CHECK(says(e, Code::frame, {"B<-A", "frame B", "inverse()", "graph/signals.cpp"}));
  Diagram d{"mounted"};
  auto B = d.add("B", brick()), A = d.add("A", brick());
  ground(B);
  const auto line = next_line();
  mount(A, B.child, kTurn.named("A", "B"));
  const Error mounted = compile_error(d);
  CHECK(mounted.mistakes().size() == 1);
  CHECK(says(mounted, Code::frame, {"B<-A", "frame B", "named(\"B\", \"A\")", line}));
}

TEST_CASE("frames: through a joint, too, a rotation is that of the body that hangs there") {
  const Rotation T = Rotation::about({0, 0, 1}, 0.3);
  const auto scene = [&](const Rotation& T_ba, int joint) {
    Diagram d{"hub and wing"};
    auto hub = d.add("hub", brick()), wing = d.add("wing", brick({}));
    release(d.add("spare", brick({})));
    hub.parent.force = -d.input("W", 6);
    if (joint == 0) hinge(d, "drive", wing, hub.child, T_ba, {0, 1, 0}).torque = 0;
    if (joint == 1) slide(d, "drive", wing, hub.child, T_ba, {0, 1, 0}).force = 0;
    if (joint == 2) mount(wing, hub.child, T_ba);
    if (joint == 3) {
      bushing(d, "drive", wing.parent, hub.child, T_ba, {.stiffness = {1, 1, 1, 1, 1, 1}});
      release(wing);
    }
    d.output("a", 6) = wing.parent.accel;
    return compile_error(d);
  };
  for (const int joint : {0, 1, 2, 3}) {
    CAPTURE(joint);
    CHECK(scene(T, joint).mistakes().empty());
    CHECK(scene(T.named("hub", "wing"), joint).mistakes().empty());
    CHECK(scene(T.named("hub", "spare"), joint).has(Code::frame));
    const Error reversed = scene(T.named("wing", "hub"), joint);
    CHECK((reversed.has(Code::frame) && reversed.mistakes().size() == 1));
    if (joint != 2)
      CHECK(says(scene(T.named("hub", "spare"), joint), Code::frame,
                 {"drive", "spare", "hub", "wing", "graph/signals.cpp"}));
    CHECK(says(reversed, Code::frame, {"named(\"hub\", \"wing\")", "graph/signals.cpp"}));
  }
}

TEST_CASE("frames: bodies mixed without a rotation are refused, in equations and in outputs") {
  Diagram d{"mixed"};
  auto B = d.add("B", brick()), A = d.add("A", brick());
  ground(B);
  const auto first = next_line();
  A.parent.accel = B.child.accel;
  const auto second = next_line();
  d.output("sum", 6) = A.parent.force + B.parent.force;
  const auto third = next_line();
  d.output("difference", 3) = A.parent.accel.linear - B.child.accel.linear;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 3);
  CHECK(says(e, Code::frame, {"A.parent.accel", "frame A", "frame B", first, "mount(A, B."}));
  CHECK(says(e, Code::frame, {"frame A", "frame B", second}));
  CHECK(says(e, Code::frame, {"frame A", "frame B", third}));
}

TEST_CASE("frames: rotations compose where the inner names agree") {
  const Rotation T_ca = kTurn.named("C", "B") * kTurn.named("B", "A");
  CHECK(T_ca.to() == "C");
  CHECK(T_ca.from() == "A");
  CHECK(matrix_error(T_ca.nominal(), Rotation::about({1, 2, 3}, 1.4).nominal()) <= 1e-15);
  CHECK(matrix_error((kTurn * kTurn.inverse()).nominal(), Matrix3d::Identity()) <= 1e-15);
  CHECK(says(error_of([] { return kTurn.named("C", "B") * kTurn.named("A", "B"); }), Code::frame,
             {"C<-B", "A<-B", "inverse"}));
}

TEST_CASE("an input takes the quantity and frame of the signals that it drives") {
  Diagram d{"adopted"};
  auto U = d.input("U", 6);
  auto B = d.add("B", brick());
  B.parent.accel = U;
  d.output("a", 6) = B.child.accel;
  d.output("u", 6) = U;
  const Eigen::MatrixXd G = compile(d).static_gain();
  CHECK(matrix_error(G.topRows(6), tau({-1, 0, 0})) <= 1e-16);
  CHECK(matrix_error(G.bottomRows(6), Matrix6::Identity()) == 0);
}

TEST_CASE("quantities: a gain makes a plain signal; without one they must agree") {
  Diagram good{"feedback"};
  auto z = good.add("z", spring());
  auto k = good.param("k", 7);
  z.parent.accel = 0;
  z.child.force = -k * z.stretch + 0.5 * k * z.stretch - k / 2 * z.stretch - 3 * z.stretch +
                  0.0 * z.child.accel + z.stretch * Value(-1) - z.stretch / 0.5;
  good.output("x") = z.stretch;
  const auto poles = compile(good).poles();
  REQUIRE(poles.size() == 1);
  CHECK(relative(poles[0].s, Complex(0, std::sqrt((26 + 7 + 3 + 1 + 2) / 2.0))) <= 1e-15);

  Diagram bad{"mixed"};
  auto y = bad.add("y", spring());
  const auto first = next_line();
  y.parent.accel = y.stretch;
  const auto second = next_line();
  bad.output("sum") = y.child.accel + y.stretch;
  const Error e = compile_error(bad);
  CHECK(e.mistakes().size() == 2);
  CHECK(says(e, Code::quantity,
             {"y.parent.accel", "acceleration", "y.stretch", "position", first, "k *"}));
  CHECK(says(e, Code::quantity, {"y.child.accel", "acceleration", second}));
}

TEST_CASE("quantities: translations and rotations, forces and torques must agree, too") {
  Diagram good{"halves"};
  auto W = good.input("W", 6);
  auto h = good.add("hub", brick());
  h.parent.force.linear = -W.linear() + W.angular();  // a plain signal may be anything
  h.parent.force.angular = 2.0 * h.child.accel.linear;
  good.output("lever", 3) = h.parent.rate.linear() + 0.5 * h.parent.rate.angular();
  CHECK_NOTHROW(compile(good));

  Diagram bad{"mixed halves"};
  auto B = bad.add("B", brick()), A = bad.add("A", brick());
  const Rotation T = kTurn.named("B", "A");
  mount(A, B.child, T);
  const auto first = next_line();
  B.parent.force.linear = T * A.child.force.angular;
  B.parent.force.angular = -(T * A.child.force.angular);
  const auto second = next_line();
  bad.output("x", 3) = B.parent.accel.linear + B.parent.accel.angular;
  const Reading p = B.parent.position;
  const Vector3d x = Vector3d::UnitX();
  const auto third = next_line();
  bad.output("y") = p.angular().along(x) - p.linear().along(x);
  const Error e = compile_error(bad);
  CHECK(e.mistakes().size() == 3);
  CHECK(says(e, Code::quantity,
             {"B.parent.force.linear", "T(B<-A) * A.child(\"C1\").force.angular", first}));
  CHECK(says(e, Code::quantity, {"B.parent.accel.linear", "B.parent.accel.angular", second}));
  CHECK(says(e, Code::quantity,
             {"B.parent.position.angular.along(1, 0, 0)", "B.parent.position.linear.along(1, 0, 0)",
              third}));
}

TEST_CASE("sizes: both sides are shown") {
  Diagram d{"sizes"};
  auto u = d.input("u", 3);
  auto B = d.add("B", brick());
  const auto first = next_line();
  B.parent.force = u;
  const auto second = next_line();
  d.output("a", 3) = B.child.accel;
  const auto third = next_line();
  d.output("b", 6) = Eigen::MatrixXd::Ones(6, 3) * B.child.accel;
  const auto fourth = next_line();
  d.output("c", 1) = kTurn * B.child.accel.along({1, 0, 0});
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 4);
  CHECK(says(e, Code::size, {"B.parent.force", "size 6", "u", "size 3", first}));
  CHECK(says(e, Code::size, {"size 3", "B.child(\"C1\").accel", "size 6", second, ".linear"}));
  CHECK(says(e, Code::size, {"6x3", "size 6", third}));
  CHECK(says(e, Code::size, {"size 1", fourth}));
}

TEST_CASE("a matrix gain: plain, in an unknown frame that is listed") {
  Diagram d{"matrix"};
  auto u = d.input("u", 2);
  auto B = d.add("B", brick({}));
  Eigen::MatrixXd M(6, 2);
  M << 1, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0;
  B.parent.accel = M * u;
  B.parent.force += 0;
  d.output("f", 2) = -1 * Eigen::MatrixXd(M.transpose()) * B.parent.force;
  const System system = compile(d);
  CHECK(unchecked(system) == 1);
  const Eigen::Matrix2d exact{{4, 0}, {0, 16}};
  CHECK(matrix_error(system.static_gain(), exact) <= 1e-16);
}

TEST_CASE("parameters give the same model as their numbers") {
  const auto scene = [](bool named) {
    Diagram d{"parameters"};
    const auto number = [&](const char* name, double x) {
      return named ? Value(d.param(name, x)) : Value(x);
    };
    auto u = d.input("u");
    auto z = d.add("z", SpringMass{.mass = number("m", 2.1),
                                   .stiffness = number("k", 26.3),
                                   .damping = number("c", 0.4),
                                   .parent_mass = number("m0", 0.7)});
    auto g = d.add("g", Gain{.gain = number("gain", 1.3)});
    auto B = d.add("B", RigidBody{.mass = number("M", 4.4), .children = {{"C1", {1, 0, 0}}}});
    auto A = d.add("A", brick());
    g.in = z.stretch;
    z.parent.force = -u - number("k2", 0.9) * g.out;
    z.child.force = u;
    B.parent.force.linear = 0;
    B.parent.force.angular = 0;
    B.parent.force += Eigen::MatrixXd::Ones(6, 1) * u;
    mount(A, B.child, Rotation::about({0, 3, 4}, number("angle", 0.3)) * kTurn);
    d.output("x") = number("out", 5.5) * z.stretch;
    d.output("a", 6) = A.parent.accel;
    return d;
  };
  const Diagram named = scene(true);
  CHECK(named.graph().parameters.size() == 9);
  const StateSpace m = compile(named).state_space(), n = compile(scene(false)).state_space();
  CHECK(m.states == n.states);
  CHECK(m.A == n.A);
  CHECK(m.B == n.B);
  CHECK(m.C == n.C);
  CHECK(matrix_error(m.D, n.D) <= 1e-14);  // rotations by numbers are multiplied out at once
}

TEST_CASE("a parameter of another diagram is refused wherever it is used") {
  Diagram other{"other"}, d{"own"};
  d.param("mine", 1);
  auto k = other.param("k", 10);
  const auto first = next_line();
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = k});
  z.parent.accel = 0;
  const auto second = next_line();
  z.child.force = k * z.stretch;
  auto B = d.add("B", brick({}));
  const auto third = next_line();
  d.output("a", 6) = Rotation::about({0, 0, 1}, k) * B.parent.accel;
  ground(B);
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 3);
  for (const auto& line : {first, second, third})
    CHECK(says(e, Code::unknown_name, {line, "param("}));
}

TEST_CASE("a parameter that this diagram has no number for is refused, beside other mistakes") {
  Diagram other{"other"}, d{"own"};
  other.param("first", 1);
  auto k = other.param("second", 10);
  const auto line = next_line();
  auto z = d.add("z", SpringMass{.stiffness = k});
  d.output("x", 2) = k * z.stretch;
  const Error e = compile_error(d);
  CHECK(e.mistakes().size() == 4);
  CHECK(says(e, Code::unknown_name, {"z", line}));
  CHECK(says(e, Code::unknown_name, {"10"}));
  CHECK(says(e, Code::size, {"x", "size 2"}));
  CHECK(error_of([&] { transfer(d.graph(), kS); }).has(Code::unknown_name));
  CHECK(to_dot(d).find("\"z\" [shape=plain") != std::string::npos);
}

TEST_CASE("parts of inputs and readings: halves of 6, components of 3") {
  Diagram d{"parts"};
  auto U = d.input("U", 6), f = d.input("f", 3);
  auto B = d.add("B", brick());
  B.parent.accel = 0;
  B.child.force.linear = U.linear();
  B.child.force.angular = 0;
  B.child.force.linear += Eigen::MatrixXd(Vector3d(0, 0, 1)) * f.along({3, 0, 4});
  d.output("support") = B.parent.reaction.linear().along({0, 0, 2});
  d.output("load") = U.angular().along({0, 1, 0});
  // B transmits its load to its support.
  Eigen::MatrixXd exact = Eigen::MatrixXd::Zero(2, 9);
  exact(0, 2) = 1;
  exact(0, 6) = 0.6;
  exact(0, 8) = 0.8;
  exact(1, 4) = 1;
  CHECK(matrix_error(compile(d).static_gain(), exact) <= 1e-15);

  CHECK(says(error_of([&] {
               U.along({1, 0, 0});
             }),
             Code::size, {"U", "size 6", ".along(1, 0, 0)", ".linear"}));
  CHECK(says(error_of([&] {
               B.parent.reaction.along({1, 0, 0});
             }),
             Code::size, {"B.parent.reaction", "size 6", ".along(1, 0, 0)"}));
  CHECK(says(error_of([&] { U.linear().angular(); }), Code::size, {"U.linear", ".angular"}));
  CHECK(says(error_of([&] {
               f.along({1, 0, 0}).along({1, 0, 0});
             }),
             Code::size, {"f.along(1, 0, 0)", "size 1"}));
}

TEST_CASE("signals of another diagram are refused") {
  Diagram a{"a"}, b{"b"};
  auto za = a.add("za", spring());
  auto zb = b.add("zb", spring());
  const auto line = next_line();
  const Error wrong = error_of([&] { za.parent.accel = zb.child.accel; });
  CHECK(says(wrong, Code::unknown_name, {"za.parent.accel", line}));
  CHECK(says(error_of([&] { za.child.force = za.parent.force + zb.parent.force; }),
             Code::unknown_name, {"Diagram"}));
  CHECK(says(error_of([&] { a.output("x") = zb.stretch; }), Code::unknown_name, {"x", "Diagram"}));
}
