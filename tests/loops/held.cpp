#include <doctest/doctest.h>

#include "assembly.hpp"
#include "support/notes.hpp"

/// Chains whose geometry immobilises some points: outputs there are 0, not rounding, bodies mounted
/// there are as on the ground, and loads still reach the ground.

using namespace loops_test;
using namespace titop;
using titop_test::dense_not_tried;
using titop_test::noted;

namespace {

constexpr double kMass = 2, kStiffness = 50, kDamping = 0.6;

/// A triangle of bars 3 and 4 long on pins 5 apart: a right angle at its apex. A spring-mass across
/// all three axes and a welded body are mounted at the apex.
struct Truss {
  Diagram d{"truss"};
  double angle_A = std::atan2(4, 3), angle_B = std::atan2(-3, 4);

  static RigidBody bar(double length) {
    return {.mass = length,
            .inertia = length * Vector3d(0.01, 0.5, 0.5).asDiagonal(),
            .PA = {length / 2, 0, 0},
            .children = {{"tip", {length, 0, 0}}}};
  }
  static Rotation turn(double angle) { return Rotation::about({0, 0, 1}, angle); }

  explicit Truss(bool closed) {
    auto base = d.add("base", RigidBody{.mass = 1, .children = {{"J1"}, {"J2", {5, 0, 0}}}});
    auto A = d.add("A", bar(3)), B = d.add("B", bar(4)), box = d.add("box", bar(0.5));
    ground(base);
    const Vector3d z{0, 0, 1};
    hinge(d, "p1", A, base.child("J1"), turn(angle_A), z).torque = 0;
    hinge(d, "p2", B, A.child, turn(angle_B - angle_A), z).torque = 0;
    if (closed) {
      auto p3 = d.add("p3", Hinge{z});
      p3.torque = 0;
      mount(p3, base.child("J2"), turn(angle_B));
      weld(B.child, p3.child);
    }
    mount(box, A.child);
    auto hung =
        d.add("hung", SpringMass{.mass = kMass, .stiffness = kStiffness, .damping = kDamping});
    mount(hung, box.child.along({1, 2, 2}));
    auto u = d.input("u");
    hung.child.force += u;
    A.child.force += d.input("F", 6);
    const auto gain = d.param("gain", 3.0);
    d.output("stretch") = hung.stretch;
    d.output("mass") = hung.child.accel;
    d.output("apex", 6) = A.child.accel;
    d.output("beyond") = gain * box.child.accel.along({0, 1, 0});
    d.output("borne", 3) = base.parent.force.linear;
  }
};

}  // namespace

TEST_CASE("a truss: only mounted bodies move, as if on the ground") {
  const Truss truss(true);
  const System system = compile(truss.d);
  CHECK(noted(system, Note::Kind::info, "chains", {"A.child(\"tip\"), box.child(\"tip\")"}));
  for (const System& s : {system, system.update({{"gain", 7}})}) {
    const StateSpace& m = s.state_space();
    CHECK(m.order() == 2);
    CHECK(s.order_verdict().decided());
    REQUIRE(s.poles().size() == 1);
    CHECK(std::abs(s.poles()[0].omega / std::sqrt(kStiffness / kMass) - 1) <= 1e-14);
    for (const Complex z : points({0.3, 5, 70})) {
      const Complex x = 1.0 / (kMass * z * z + kDamping * z + kStiffness);
      for (const MatrixXcd& G : {s.transfer(z), m.transfer(z)}) {
        CHECK(std::abs(G(0, 0) / x - 1.0) <= 1e-13);
        CHECK(std::abs(G(1, 0) / (z * z * x) - 1.0) <= 1e-13);
        CHECK(G.block(2, 0, 7, 7).isZero(0));  // apex, beyond
        CHECK(G.block(0, 1, 2, 6).isZero(0));
        // The force on the apex is in the frame of bar A.
        const MatrixXd turned = Truss::turn(truss.angle_A).nominal();
        CHECK((G.block(9, 1, 3, 3) - turned).cwiseAbs().maxCoeff() <= 1e-13);
        CHECK(G.block(9, 4, 3, 3).cwiseAbs().maxCoeff() <= 1e-13);
      }
    }
    CHECK(certify(s).holds());
  }
}

TEST_CASE("the same bars left open move") {
  const System system = compile(Truss(false).d);
  CHECK(!noted(system, Note::Kind::info, "chains", {"A.child(\"tip\")"}));
  const MatrixXcd G = system.transfer({0.1, 1});
  CHECK(G.block(2, 1, 3, 3).cwiseAbs().maxCoeff() >= 1e-3);
}

TEST_CASE("a hub of many points between two pins that are not parallel is immobile") {
  Diagram d{"hub"};
  RigidBody spec{.mass = 3};
  for (int k = 0; k < 9; ++k)
    spec.children.push_back({"C" + std::to_string(k), {0.1 * k, 0.3, -0.2 * k}});
  auto hub = d.add("hub", spec);
  release(hub);
  for (int k = 0; k < 2; ++k) {
    auto pin = d.add("pin" + std::to_string(k), Hinge{{k ? 0.0 : 1.0, 0.6, 0.8}});
    pin.torque = 20.0 * pin.angle;
    mount(pin, hub.child("C" + std::to_string(k)));
    ground(pin.child);
  }
  auto hung =
      d.add("hung", SpringMass{.mass = kMass, .stiffness = kStiffness, .damping = kDamping});
  mount(hung, hub.child("C7").along({1, 2, 2}));
  hung.child.force += d.input("u");
  d.output("stretch") = hung.stretch;
  d.output("hub", 6) = hub.child("C8").accel;
  const System system = compile(d);
  CHECK(system.order() == 2);
  for (const Complex z : points({0.3, 5, 70})) {
    const Complex x = 1.0 / (kMass * z * z + kDamping * z + kStiffness);
    const MatrixXcd G = system.transfer(z);
    CHECK(std::abs(G(0, 0) / x - 1.0) <= 1e-13);
    CHECK(G.bottomRows(6).isZero(0));
  }
}

namespace {

/// B on a sprung slide of the hub, whose direction leaves the plane of the two sprung slides of a
/// closing joint by `tilt`: it cannot move. Next to it A slides freely against its spring.
Diagram wedged(double tilt, bool welded) {
  Diagram d{"wedged"};
  const Vector3d far(0.6, 0.1, -0.7), root(1, 0.3, 0.2), u(0, 1, 0.2), v(0.3, 0.1, 1);
  const auto body = [](double mass, std::vector<ChildPoint> children) {
    return RigidBody{.mass = mass,
                     .inertia = mass * Vector3d(0.2, 0.3, 0.4).asDiagonal(),
                     .PA = {0.2, 0.1, 0.1},
                     .children = std::move(children)};
  };
  const auto spring = [](const auto& axis, double k) {
    axis.force = k * axis.position + 0.01 * k * axis.rate;
  };
  auto hub = d.add("hub", body(5, {{"A", {0.1, -0.4, 0.8}}, {"B", root}, {"E", root + far}}));
  auto A = d.add("A", body(3, {{"far", {0.2, 0.9, 0.1}}})), B = d.add("B", body(2, {{"far", far}}));
  hub.parent.force = -d.input("U", 6);
  spring(joint(d, "s", A, hub.child("A"), {}, {along({1, 2, 0.1}, "s")}).axis("s"), 60);
  if (welded) {
    mount(B, hub.child("B"));
  } else {
    const Vector3d way = 0.4 * u + 0.7 * v + tilt * Vector3d(1, 0, 0);
    spring(joint(d, "g", B, hub.child("B"), {}, {along(way, "g")}).axis("g"), 80);
    auto h = d.add("h", Joint{{along(u, "u"), along(v, "v")}});
    for (const char* axis : {"u", "v"}) spring(h.axis(axis), 50);
    mount(h, B.child("far")), weld(h.child, hub.child("E"));
  }
  d.output("hub", 6) = hub.parent.accel;
  d.output("far", 6) = A.child("far").accel;
  return d;
}

}  // namespace

TEST_CASE(
    "springs along motions that a chain nearly allows: as welded, to the digits of its angles") {
  // Far below all modes the factors of such a chain have no digit; the model is checked elsewhere,
  // and the log reports it.
  for (const double tilt : {1e-2, 1e-4, 1e-5, 1e-6}) {
    CAPTURE(tilt);
    const System welded = compile(wedged(tilt, true)), held = compile(wedged(tilt, false));
    CHECK(held.order() == welded.order());
    const std::vector<Complex> s = points({0.5, 3, 40});
    const double lost = 1e-15 / tilt;  // of the motion out of the plane
    CHECK(error_3(responses(held, s), responses(welded, s)) <= 10 * lost);
    CHECK(error_3(responses(held.state_space(), s), responses(welded, s)) <= 1e3 * lost);
    welded.state_space();
    CHECK(!dense_not_tried(welded));
    CHECK((tilt > 1e-5 || dense_not_tried(held)));
  }
}
