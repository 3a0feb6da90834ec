#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "support/names.hpp"

/// With truncated modes a child point may be rigid in some directions. The log reports it if a body
/// is fixed there.

using namespace titop;
using titop_test::has_name;
using titop_test::has_names;

namespace {

constexpr double kPi = std::numbers::pi;

FlexibleBody bar(double length, fe::ModeOptions modes) {
  modes.xi = {0.002};
  return Beam{.length = length,
              .section = tube(0.03, 0.026),
              .material = {.E = 120e9, .nu = 0.3, .rho = 1600},
              .elements = 2,
              .modes = std::move(modes)};
}

RigidBody load() { return {.mass = 20, .PA = {0.2, 0, 0}}; }

std::string stiff(const Diagram& d) {
  for (const Note& n : compile(d).notes())
    if (n.pass == "check" && n.kind == Note::Kind::info) return n.text;
  return {};
}

/// A bar on the ground; `hang` mounts something on its end.
template <class Hang>
std::string note(fe::ModeOptions modes, Hang hang) {
  Diagram d{"bar"};
  auto W = d.input("W", 6);
  auto b = d.add("b", bar(1.2, std::move(modes)));
  ground(b);
  hang(d, b);
  b.child.force += W;
  d.output("x", 6) = b.child.position;
  return stiff(d);
}

}  // namespace

TEST_CASE("a body on a point that the kept modes leave rigid: the log names it") {
  // Four modes bend: in y with rz and in z with ry; along x and about x nothing moves.
  const auto mounted = [](Diagram& d, BodyHandle& b) { mount(d.add("load", load()), b.child); };
  const std::string said = note({.kept = 4}, mounted);
  CHECK(has_names(said, {"b.child(\"C\")", "2", "6"}));
  CHECK(note({.kept = 4, .residual = {"C"}}, mounted).empty());
  CHECK(note({}, mounted).empty());
}

TEST_CASE("nothing is said where nothing heavy is fixed to it in all directions") {
  CHECK(note({.kept = 4}, [](Diagram&, BodyHandle&) {}).empty());
  CHECK(note({.kept = 4}, [](Diagram& d, BodyHandle& b) {
          mount(d.add("z", SpringMass{.mass = 2, .stiffness = 5}), b.child.along({0, 0, 1}));
        }).empty());
  CHECK(note({.kept = 4}, [](Diagram& d, BodyHandle& b) {
          auto held = d.add("load", load());
          joint(d, "ball", held, b.child, {}, ball());
        }).empty());
  Diagram rigid{"a rigid body is meant to be one"};
  auto hub = rigid.add("hub", FlexibleBody{RigidBody{.mass = 4, .children = {{"C"}}}});
  hub.parent.force = -rigid.input("W", 6);
  mount(rigid.add("load", load()), hub.child);
  rigid.output("a", 6) = hub.parent.accel;
  CHECK(stiff(rigid).empty());
}

namespace {

/// Three bars in a square with a hub, the last corner welded.
Diagram square(const fe::ModeOptions& modes) {
  Diagram d{"square"};
  auto W = d.input("W", 6);
  auto hub = d.add("hub", RigidBody{.mass = 200,
                                    .inertia = Vector3d(30, 40, 50).asDiagonal(),
                                    .children = {{"A", {0, 0.3, 0}}, {"B", {0, -0.3, 0}}}});
  hub.parent.force = -W;
  auto a = d.add("a", bar(0.8, modes)), b = d.add("b", bar(0.8, modes)),
       c = d.add("c", bar(0.6, modes));
  const Rotation turn = Rotation::about({0, 0, 1}, kPi / 2);
  mount(a, hub.child("A"));
  mount(b, hub.child("B"));
  mount(c, b.child, turn);
  weld(c.child, a.child, turn);
  d.output("a", 6) = hub.parent.accel;
  return d;
}

}  // namespace

TEST_CASE("a closing weld counts on both sides") {
  const std::string said = stiff(square({.kept = 6}));
  for (const char* name : {"a.child", "b.child", "c.child"}) {
    CAPTURE(name);
    CHECK(has_name(said, name));
  }
}

TEST_CASE("a square of six modes each: the first frequency hides the error of the third") {
  const auto all = compile(square({})).poles(), six = compile(square({.kept = 6})).poles(),
             residual = compile(square({.kept = 6, .residual = {"C"}})).poles();
  CHECK(std::abs(six[0].omega / all[0].omega - 1) <= 3e-3);
  CHECK(six[2].omega / all[2].omega > 2);
  for (std::size_t i = 0; i < 3; ++i) {
    CAPTURE(i);
    CHECK(std::abs(residual[i].omega / all[i].omega - 1) <= 1e-3);
  }
}
