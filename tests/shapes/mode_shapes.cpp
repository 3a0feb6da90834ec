// Mode shapes against closed forms: beams, bodies on springs, damped pairs, turned frames.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;
using std::numbers::pi;

namespace {

using Complex = std::complex<double>;

std::size_t point(const ModeShapes& shapes, const std::string& name) {
  for (std::size_t i = 0; i < shapes.points.size(); ++i)
    if (shapes.points[i].name == name) return i;
  FAIL("there is no point " << name);
  return 0;
}

Vector3d place(const ModeShapes& shapes, const std::string& name) {
  return shapes.points[point(shapes, name)].place;
}

Eigen::Vector3cd moved(const ModeShapes& shapes, const std::string& name, std::size_t mode = 0) {
  return shapes.modes[mode].translation.col(static_cast<Eigen::Index>(point(shapes, name)));
}

Eigen::Vector3cd turned(const ModeShapes& shapes, const std::string& name) {
  return shapes.modes[0].rotation.col(static_cast<Eigen::Index>(point(shapes, name)));
}

/// A round cantilever of `pieces` beams, each turned about its axis by 0.4 rad from the one before,
/// pushed at its end along y of the first.
System cantilever(int pieces, double length) {
  Diagram d{"cantilever"};
  auto u = d.input("push");
  const FlexibleBody piece{modal_data(Beam{.length = length / pieces,
                                           .section = circle(0.03),
                                           .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                           .elements = 4})};
  auto before = d.add("B0", piece);
  ground(before);
  for (int i = 1; i < pieces; ++i) {
    auto next = d.add("B" + std::to_string(i), piece);
    mount(next, before.child, Rotation::about({1, 0, 0}, 0.4));
    before = next;
  }
  const double angle = 0.4 * (pieces - 1);
  before.child.force.along({0, std::cos(angle), -std::sin(angle)}) += u;
  d.output("tip", 6) = before.child.accel;
  return compile(d);
}

/// Clamped-free: y(x) and y'(x) for a tip displacement of 1 [Blevins 1979, table 8-1].
struct ClampedFree {
  double beta, length;
  double sigma() const {
    return (std::cosh(beta) + std::cos(beta)) / (std::sinh(beta) + std::sin(beta));
  }
  double raw(double z) const {
    return std::cosh(z) - std::cos(z) - sigma() * (std::sinh(z) - std::sin(z));
  }
  double y(double x) const { return raw(beta * x / length) / raw(beta); }
  double slope(double x) const {
    const double z = beta * x / length;
    return (std::sinh(z) + std::sin(z) - sigma() * (std::cosh(z) - std::cos(z))) * beta / length /
           raw(beta);
  }
};

/// Free masses m1, m2 on a spring and damper along x of the second; the frame of the second body is
/// turned by 90 degrees about z, the first has its port at (1, 2, 3).
Diagram pair_of_bodies(double m1, double m2, double k, double c) {
  Diagram d{"pair"};
  auto u = d.input("push");
  const Rotation T = Rotation::about({0, 0, 1}, pi / 2);
  auto a = d.add("a", RigidBody{.mass = m1, .children = {{"C", Vector3d(1, 2, 3)}}});
  auto spring = d.add(
      "spring", Bushing{.stiffness = {k, 1e3, 1e3, 1e3, 1e3, 1e3}, .damping = {c, 0, 0, 0, 0, 0}});
  auto b = d.add("b", RigidBody{.mass = m2, .children = {{"end", Vector3d(0.5, 0, 0)}}});
  a.parent.accel.angular = 0;
  release(a);
  mount(spring, a.child("C"), T);
  mount(b, spring.child);
  b.child("end").force.along({1, 0, 0}) += u;
  d.output("x") = b.parent.accel.along({1, 0, 0});
  return d;
}

int pair_at(const System& system, double omega) {
  const std::vector<Pole> poles = system.poles();
  int best = 0;
  for (std::size_t i = 0; i < poles.size(); ++i)
    if (relative(poles[i].omega, omega) <
        relative(poles[static_cast<std::size_t>(best)].omega, omega))
      best = static_cast<int>(i);
  return best;
}

ModeShapes shapes_at(const System& system, double omega) {
  const int place[] = {pair_at(system, omega)};
  return mode_shapes(system, place);
}

}  // namespace

TEST_CASE("a cantilever's first two modes, in frames that turn along it") {
  constexpr int kPieces = 4;
  constexpr double kLength = 2;
  const System system = cantilever(kPieces, kLength);
  const double omega = std::sqrt(70e9 / 2700) * 0.03 / 4 / (kLength * kLength);  // times beta^2
  for (const double beta : {1.8751040687119611, 4.6940911329741745}) {
    CAPTURE(beta);
    const ClampedFree theory{beta, kLength};
    const ModeShapes s = shapes_at(system, beta * beta * omega);
    // The error of cubic elements of length h is (beta h)^4 / 720: 4e-5 of a frequency squared.
    const double h = beta / (4 * kPieces), close = std::pow(h, 4);
    CHECK(relative(s.modes[0].pole.omega, beta * beta * omega) <= close);
    CHECK(place(s, "B0.parent").norm() == 0);
    for (int i = 0; i < kPieces; ++i) {
      const std::string name = "B" + std::to_string(i) + ".C";
      const double x = kLength * (i + 1) / kPieces;
      CHECK((place(s, name) - Vector3d(x, 0, 0)).norm() <= 1e-14);
      CHECK((moved(s, name) - Vector3d(0, theory.y(x), 0)).norm() <= close);
      CHECK((turned(s, name) - Vector3d(0, 0, theory.slope(x))).norm() <= close * beta);
    }
    CHECK(moved(s, "B0.parent").norm() <= 1e-9);
  }
}

TEST_CASE("of the two equal bendings of a round beam an input moves one") {
  const System system = cantilever(4, 2);
  const int first[] = {0, 1};
  REQUIRE(relative(system.poles()[0].omega, system.poles()[1].omega) <= 1e-8);
  const ModeShapes s = mode_shapes(system, first);
  CHECK(s.modes.size() == 1);
  REQUIRE(s.without.size() == 1);
  CHECK(s.without[0].find("no input") != std::string::npos);
  const int second[] = {1};
  CHECK(error_of([&] { mode_shapes(system, second); }).has(Code::bad_value));
}

TEST_CASE("two bodies on a spring: amplitudes as the inverse masses, in the first body's frame") {
  const double m1 = 3, m2 = 0.5, k = 40;
  const ModeShapes s = shapes_at(compile(pair_of_bodies(m1, m2, k, 0)), std::sqrt(k / m1 + k / m2));
  CHECK((place(s, "a.C") - Vector3d(1, 2, 3)).norm() <= 1e-15);
  CHECK((place(s, "b.end") - Vector3d(1, 2.5, 3)).norm() <= 1e-15);
  CHECK((moved(s, "b.end") - Vector3d(0, 1, 0)).norm() <= 1e-9);
  CHECK((moved(s, "a.parent") - Vector3d(0, -m2 / m1, 0)).norm() <= 1e-9);
  CHECK(s.notes.empty());
  // A line for each body's other points.
  CHECK(s.lines.size() == 3);
}

TEST_CASE("a damped chain: complex ratios from the rows of M s^2 + D s + K") {
  const double m1 = 2, m2 = 1, k1 = 50, k2 = 30, c2 = 3;
  Diagram d{"damped"};
  auto u = d.input("push");
  auto a = d.add("a", Bushing{.stiffness = {k1, 1e4, 1e4, 1e4, 1e4, 1e4}});
  auto body_a = d.add("A", RigidBody{.mass = m1, .children = {{"C"}}});
  auto b = d.add(
      "b", Bushing{.stiffness = {k2, 1e4, 1e4, 1e4, 1e4, 1e4}, .damping = {c2, 0, 0, 0, 0, 0}});
  auto body_b = d.add("B", RigidBody{.mass = m2, .children = {{"C"}}});
  ground(a);
  mount(body_a, a.child);
  mount(b, body_a.child("C"));
  mount(body_b, b.child);
  body_b.child("C").force.along({1, 0, 0}) += u;
  d.output("x") = body_b.child("C").accel.along({1, 0, 0});
  const System system = compile(d);
  for (int i = 0; i < 2; ++i) {
    const int wanted[] = {i};
    const ModeShapes shapes = mode_shapes(system, wanted);
    const Complex s = shapes.modes[0].pole.s;
    const Complex link = k2 + c2 * s, expected = (m2 * s * s + link) / link;  // x_A / x_B
    const Complex ratio = moved(shapes, "A.C")(0) / moved(shapes, "B.C")(0);
    CHECK(std::abs(ratio - expected) <= 1e-9 * std::abs(expected));
    // The largest translation is 1 m.
    CHECK(std::abs(std::max(std::abs(moved(shapes, "A.C")(0)), std::abs(moved(shapes, "B.C")(0))) -
                   1) <= 1e-12);
  }
}

TEST_CASE("a spring-mass on an axis of a body moves along that axis") {
  Diagram d{"slosh"};
  auto u = d.input("push");
  auto hub = d.add("hub", RigidBody{.mass = 4, .children = {{"C", Vector3d(0, 1, 0)}}});
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 20});
  hub.parent.accel.angular = 0;
  release(hub);
  mount(z, hub.child("C").along({0, 3, 4}));
  z.child.force += u;
  d.output("x") = z.stretch;
  const ModeShapes s = shapes_at(compile(d), std::sqrt(20 * (1 + 1 / 4.0)));
  CHECK((place(s, "z.child") - Vector3d(0, 1, 0)).norm() <= 1e-15);
  CHECK((moved(s, "z.child") - Vector3d(0, 0.6, 0.8)).norm() <= 1e-9);
  CHECK((moved(s, "hub.parent") + 0.25 * Vector3d(0, 0.6, 0.8)).norm() <= 1e-9);
}

TEST_CASE("without inputs forces at all points excite the modes") {
  Diagram d{"free"};
  auto beam =
      d.add("beam", FlexibleBody{modal_data(Beam{.length = 1,
                                                 .section = rectangle(0.02, 0.01),
                                                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                                 .elements = 3})});
  ground(beam);
  d.output("tip", 6) = beam.child.accel;
  const System system = compile(d);
  const int first[] = {0};
  const ModeShapes s = mode_shapes(system, first);
  CHECK((moved(s, "beam.C") - Vector3d(0, 0, 1)).norm() <= 1e-9);  // the thin side
}

TEST_CASE("places follow the values of update") {
  Diagram d{"arm"};
  auto u = d.input("push");
  auto angle = d.param("angle", 0);
  auto base = d.add("base", Bushing{.stiffness = {9, 9, 9, 9, 9, 9}});
  auto arm = d.add("arm", RigidBody{.children = {{"tip", Vector3d(2, 0, 0)}}});
  ground(base);
  mount(arm, base.child, Rotation::about({0, 0, 1}, angle));
  arm.child("tip").force.along({0, 1, 0}) += u;
  d.output("y") = arm.child("tip").accel.along({0, 1, 0});
  const System system = compile(d).update({{"angle", 0.3}});
  const int first[] = {0};
  const ModeShapes s = mode_shapes(system, first);
  CHECK((place(s, "arm.tip") - 2 * Vector3d(std::cos(0.3), std::sin(0.3), 0)).norm() <= 1e-15);
}

namespace {

/// Two points of one motion, without kinematics.
class Silent : public Block {
 public:
  std::string_view type() const override { return "Silent"; }
  const Interface& interface() const override { return interface_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override {
    auto d = std::make_shared<Dynamics>();
    d->A = Eigen::MatrixXd(0, 0), d->B = Eigen::MatrixXd(0, 12), d->C = Eigen::MatrixXd(12, 0);
    d->D = Eigen::MatrixXd::Zero(12, 12);
    d->D.topRightCorner<6, 6>().setIdentity(), d->D.bottomLeftCorner<6, 6>().setIdentity();
    return d;
  }

 private:
  Interface interface_{.channels = {{.name = "C", .takes = Takes::force},
                                    {.name = "parent", .takes = Takes::accel}}};
};

struct SilentSpec {
  struct Handle {
    Handle(Graph* graph, int node)
        : child(titop::detail::channel<6>(graph, node, 0)),
          parent(titop::detail::channel<6>(graph, node, 1)) {}
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return titop::detail::rebind(*this, other); }
    DualPort<6> child, parent;
  };
};

BlockPtr as_block(const SilentSpec&) { return std::make_shared<Silent>(); }

}  // namespace

TEST_CASE("blocks without positions are named, and points behind them begin at their own origin") {
  Diagram d{"broken"};
  auto u = d.input("push");
  auto base = d.add("base", Bushing{.stiffness = {9, 9, 9, 9, 9, 9}});
  auto link = d.add("link", SilentSpec{});
  auto arm = d.add("arm", RigidBody{.children = {{"tip", Vector3d(2, 0, 0)}}});
  ground(base);
  mount(link, base.child);
  mount(arm, link.child);
  arm.child("tip").force.along({0, 1, 0}) += u;
  d.output("y") = arm.child("tip").accel.along({0, 1, 0});
  const int first[] = {0};
  const ModeShapes s = mode_shapes(compile(d), first);
  REQUIRE(s.notes.size() == 2);
  CHECK(has_names(s.notes[0], {"link"}));
  CHECK(has_names(s.notes[1], {"base", "link"}));
}

TEST_CASE("no shape, and why") {
  Diagram masses{"masses"};
  auto u = masses.input("u");
  auto z = masses.add("z", SpringMass{.mass = 1, .stiffness = 4});
  ground(z);
  z.child.force = u;
  masses.output("x") = z.stretch;
  const int first[] = {0}, none[] = {7};
  const System scalar = compile(masses);
  CHECK(says(error_of([&] { mode_shapes(scalar, first); }), Code::bad_value, {"masses"}));
  CHECK(
      says(error_of([&] { mode_shapes(scalar, none); }), Code::unknown_name, {"masses", "7", "1"}));

  Diagram d{"free"};
  auto push = d.input("push");
  auto hub = d.add("hub", RigidBody{.mass = 4, .children = {{"C", Vector3d(0, 1, 0)}}});
  auto rest = d.add("rest", RigidBody{.mass = 1});
  release(hub);
  mount(rest, hub.child("C"));
  hub.child("C").force.along({1, 0, 0}) += push;
  d.output("x") = hub.parent.position.linear().along({1, 0, 0});
  const System rigid = compile(d);
  CHECK(says(error_of([&] { mode_shapes(rigid, first); }), Code::bad_value, {"rigid"}));
}
