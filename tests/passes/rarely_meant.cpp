#include <doctest/doctest.h>

#include <numbers>
#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/titop.hpp>

#include "support/names.hpp"
#include "support/notes.hpp"

/// Legal input that is rarely intended leads to a warning: springs of the wrong sign, inputs
/// without outputs, degrees for radians. The sign of an input on a parent is noted.

using namespace titop;
using titop_test::has_name;
using titop_test::has_names;

namespace {

constexpr double kPi = std::numbers::pi;

/// The warnings of the pass `check`.
std::vector<std::string> warnings(const Diagram& d) {
  std::vector<std::string> result;
  for (const Note& n : compile(d).notes())
    if (n.kind == Note::Kind::warning && n.pass == "check") result.push_back(n.text);
  return result;
}

/// A wing on a hinge of a free hub; `drive` gives the hinge's torque.
template <class Drive>
std::vector<std::string> warnings_of(Drive drive, const Rotation& T = {}) {
  Diagram d{"hub and wing"};
  auto W = d.input("W", 6);
  auto hub = d.add("hub", RigidBody{.mass = 40, .children = {{"C", {0, 1, 0}}}});
  auto wing = d.add("wing", RigidBody{.mass = 3, .PA = {0.5, 0, 0}, .children = {{"tip"}}});
  hub.parent.force = -W;
  auto h = hinge(d, "h", wing, hub.child, T, {0, 0, 1});
  drive(d, hub, wing, h);
  d.output("a", 6) = hub.parent.accel;
  return warnings(d);
}

}  // namespace

TEST_CASE("a spring or damper that drives its joint away is warned of") {
  const auto torque = [](double k, double c) {
    return warnings_of([=](Diagram& d, auto&, auto&, auto& h) {
      h.torque = k * h.angle + c * h.rate - d.input("u");
    });
  };
  CHECK(torque(900, 0.5).empty());
  CHECK(torque(0, 0).empty());
  const auto both = torque(-900, -0.5);
  REQUIRE(both.size() == 1);
  CHECK(has_names(both[0], {"h.torque = -900 * h.angle - 0.5 * h.rate - u", "+ k * h.angle",
                            "+ c * h.rate", "passes/rarely_meant.cpp"}));
  const auto spring = torque(-900, 0.5), damper = torque(900, -0.5);
  REQUIRE((spring.size() == 1 && damper.size() == 1));
  const char *own_spring = "+ k * h.angle", *own_damper = "+ c * h.rate";
  CHECK((has_name(spring[0], own_spring) && !has_name(spring[0], own_damper)));
  CHECK((has_name(damper[0], own_damper) && !has_name(damper[0], own_spring)));
}

TEST_CASE("the sum of direct terms in a joint's own angle counts") {
  CHECK(warnings_of([](Diagram& d, auto&, auto&, auto& h) {  // a law, of any sign
          auto law = d.add("law", Gain{.gain = -900.0});
          law.in = h.angle;
          h.torque = law.out;
        })
            .empty());
  CHECK(warnings_of([](Diagram&, auto&, auto&, auto& h) {  // 900 - 200 holds
          h.torque = 900.0 * h.angle - 200.0 * h.angle;
        })
            .empty());
  CHECK(warnings_of([](Diagram& d, auto&, auto&, auto& h) {
          h.torque = d.param("k", -2.0) * h.angle;
        }).size() == 1);
}

TEST_CASE("at a child point the force acts on the body: a spring there has the other sign") {
  const auto tip = [](double k) {
    return warnings_of([=](Diagram&, auto&, auto& wing, auto& h) {
      h.torque = 0;
      wing.child.force.linear = k * wing.child.position.linear();
    });
  };
  CHECK(tip(-50).empty());
  const auto wrong = tip(50);
  REQUIRE(wrong.size() == 1);
  CHECK(has_name(wrong[0], "- k * wing.child(\"tip\").position"));
}

TEST_CASE("on six degrees of freedom the axes that are driven count, one by one") {
  const auto attitude = [](const Matrix3d& K) {
    return warnings_of([=](Diagram&, auto& hub, auto&, auto& h) {
      h.torque = 0;
      hub.parent.force.angular += K * hub.parent.position.angular();
    });
  };
  Matrix3d gyroscopic = Matrix3d::Zero();
  gyroscopic << 0, -3, 1, 3, 0, 2, -1, -2, 0;
  CHECK(attitude(4 * Matrix3d::Identity() + gyroscopic).empty());
  CHECK(attitude(gyroscopic).empty());
  CHECK(attitude(Vector3d(4, 4, -1).asDiagonal()).size() == 1);
  // Another direction than the one that is read: no gain on the force's own.
  CHECK(warnings_of([](Diagram&, auto& hub, auto&, auto& h) {
          h.torque = 0;
          hub.parent.force.angular.along({1, 1, 0}) +=
              3.0 * hub.parent.position.angular().along({1, -1, 0});
        }).empty());
}

TEST_CASE("an input on a parent's force is noted with its sign on the body, and the other sign") {
  const auto signs = [](auto drive) {
    Diagram d{"signs"};
    auto hub = d.add("hub", RigidBody{.mass = 40, .children = {{"C"}}});
    drive(hub, d.input("U", 6));
    d.output("a", 6) = hub.parent.accel;
    const System system = compile(d);
    return titop_test::count_notes(system, Note::Kind::info, "check",
                                   {"hub", "U", "-U", "passes/rarely_meant.cpp"});
  };
  CHECK(signs([](auto& hub, auto U) { hub.parent.force = U; }) == 1);
  CHECK(signs([](auto& hub, auto U) { hub.parent.force = Rotation() * U; }) == 1);
  CHECK(signs([](auto& hub, auto U) {
          release(hub);
          hub.parent.force += U;
        }) == 1);
  CHECK(signs([](auto& hub, auto U) { hub.parent.force = -U; }) == 0);
  CHECK(signs([](auto& hub, auto U) { hub.parent.force = -1.0 * U; }) == 0);
  CHECK(signs([](auto& hub, auto U) {
          release(hub);
          hub.parent.force -= U;
        }) == 0);
  CHECK(signs([](auto& hub, auto U) {  // on the body at C
          release(hub);
          hub.child.force = U;
        }) == 0);
}

TEST_CASE("inputs and no output: the log shows how to write one") {
  Diagram d{"forgotten"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 3});
  ground(z);
  CHECK(warnings(d).empty());  // no inputs: legal if only poles are needed
  z.child.force = d.input("u");
  const auto none = warnings(d);
  REQUIRE(none.size() == 1);
  CHECK(has_name(none[0], "d.output("));
  d.output("x") = z.stretch;
  CHECK(warnings(d).empty());
}

TEST_CASE("a rotation by more than a turn is told once, and is that rotation all the same") {
  const auto turned = [](const Value& angle) {
    return warnings_of([](Diagram&, auto&, auto&, auto& h) { h.torque = 0; },
                       Rotation::about({1, 2, 2}, 0.4) * Rotation::about({0, 0, 3}, angle));
  };
  CHECK(turned(kPi / 2).empty());
  CHECK(turned(-2 * kPi).empty());
  const auto ninety = turned(-90);
  REQUIRE(ninety.size() == 1);
  CHECK(
      has_names(ninety[0], {"90 rad", "h.parent.accel", "1.5708 rad", "passes/rarely_meant.cpp"}));

  const double c = std::cos(90.0), s = std::sin(90.0);
  Matrix3d T;
  T << c, -s, 0, s, c, 0, 0, 0, 1;
  CHECK((Rotation::about({0, 0, 3}, 90).nominal() - T).cwiseAbs().maxCoeff() <= 1e-15);
}

TEST_CASE("update warns of degrees as compile does, and only while they last") {
  Diagram d{"turned"};
  const Param angle = d.param("angle", 0.5);
  auto hub = d.add("hub", RigidBody{.mass = 40, .children = {{"C", {1, 0, 0}}}});
  auto wing = d.add("wing", RigidBody{.mass = 3, .PA = {0.5, 0, 0}});
  hub.parent.force = -d.input("U", 6);
  mount(wing, hub.child, Rotation::about({0, 0, 1}, angle));
  d.output("a", 6) = wing.parent.accel;
  const auto degrees = [](const System& system, const char* size) {
    return titop_test::count_notes(system, Note::Kind::warning, "check",
                                   {size, "wing.parent.accel", "passes/rarely_meant.cpp"});
  };
  const System radians = compile(d), once = radians.update({{"angle", 30}}),
               again = once.update({{"angle", -45}}), back = again.update({{"angle", 0.6}});
  CHECK(degrees(radians, "rad") == 0);
  CHECK(degrees(once, "30 rad") == 1);
  CHECK((degrees(again, "45 rad") == 1 && degrees(again, "rad") == 1));
  CHECK(degrees(back, "rad") == 0);
}

TEST_CASE("a diagram file keeps the data of the warnings") {
  Diagram d{"file"};
  auto body = d.add("body", RigidBody{.mass = 2}), other = d.add("other", RigidBody{.mass = 3});
  auto hub = d.add("hub", RigidBody{.mass = 9, .children = {{"A"}, {"B"}}});
  hub.parent.force = 5.0 * hub.parent.position - d.input("W", 6);
  mount(body, hub.child("A"), Rotation::about({0, 1, 0}, 30));
  hinge(d, "h", other, hub.child("B"), {}, {0, 0, 1}).torque = 0;
  d.output("a", 6) = body.parent.accel;
  const std::string json = diagram_json(d);
  const Diagram again = parse_diagram(json);
  CHECK(diagram_json(again) == json);
  const auto said = warnings(again);
  REQUIRE(said.size() == 1);
  CHECK(has_names(said[0], {"30 rad", "body.parent.accel", "equations["}));
}
