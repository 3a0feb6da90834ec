#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Structurally singular scenes: surplus and missing equations, in ports, part by part, and cures
/// that repair them.

using namespace titop;
using namespace titop_test;

namespace {

RigidBody brick() {
  return {.mass = 4, .inertia = Matrix3d::Identity(), .children = {{"C", {1, 0, 0}}}};
}

/// A rigid body imposed twice, or with the named cure: another side of one channel.
enum class Cure { none, child_force, parent_force };
Diagram imposed(Cure cure, const char* name = "A", Diagram d = Diagram{"imposed"}) {
  auto u = d.input(fmt::format("u{}", name), 6), v = d.input(fmt::format("v{}", name), 6);
  auto A = d.add(name, brick());
  if (cure == Cure::parent_force)
    A.parent.force = u;
  else
    A.parent.accel = u;
  if (cure == Cure::child_force)
    A.child.force = v;
  else
    A.child.accel = v;
  d.output(fmt::format("y{}", name), 6) =
      cure == Cure::child_force ? A.child.accel.expr() : A.child.force.expr();
  return d;
}

}  // namespace

TEST_CASE("structure: equations too many, signals missing, and cures that repair the scene") {
  const Error e = compile_error(imposed(Cure::none));
  REQUIRE(e.mistakes().size() == 1);
  CHECK(
      says(e, Code::structure,
           {"6", "A.child(\"C\").accel, A.parent.accel", "A.child(\"C\").force, A.parent.force",
            "A.parent.accel = uA", "A.child(\"C\").accel = vA", "index_reduction/structure.cpp"}));
  CHECK(has_names(e.mistakes().front().hint, {"A.child(\"C\").force", "A.child(\"C\").accel",
                                              "A.parent.force", "A.parent.accel"}));
  for (const Cure cure : {Cure::child_force, Cure::parent_force})
    CHECK(compile_error(imposed(cure)).mistakes().empty());
}

TEST_CASE("structure: the cure names the imposed motion, not the mounts of bodies") {
  Diagram d{"chain"};
  auto a = d.add("a", brick()), b = d.add("b", brick()), c = d.add("c", brick());
  a.parent.accel = 0;
  mount(b, a.child);
  mount(c, b.child);
  c.child.accel = d.input("U", 6);
  d.output("y", 6) = b.parent.accel;
  const Error e = compile_error(d);
  CHECK(says(e, Code::structure, {"b.parent.accel = a.child"}));
  const std::string& hint = e.mistakes().front().hint;
  CHECK(has_names(
      hint, {"a.parent.force", "a.parent.accel", "c.child(\"C\").force", "c.child(\"C\").accel"}));
  CHECK(!has_name(hint, "b.parent"));
}

TEST_CASE("structure: two bodies imposed twice are two mistakes") {
  const Error e = compile_error(imposed(Cure::none, "B", imposed(Cure::none)));
  REQUIRE(e.mistakes().size() == 2);
  for (const Mistake& m : e.mistakes()) {
    const bool of_A = m.message.find("A.parent") != std::string::npos;
    const std::string text = Error(m).what();
    CHECK(text.find(of_A ? "B.parent" : "A.parent") == std::string::npos);
  }
}

TEST_CASE("structure: one axis of a joint imposed beside both its ends") {
  const auto scene = [](bool torque) {
    Diagram d{"overheld"};
    auto u = d.input("u"), w = d.input("w");
    auto B = d.add("B", brick()), A = d.add("A", brick());
    B.parent.accel = 0;
    auto h = hinge(d, "h", A, B.child, Rotation{}, {0, 0, 1});
    A.child.force.linear = 0;
    A.child.force.angular.along({1, 0, 0}) = 0;
    A.child.force.angular.along({0, 1, 0}) = 0;
    A.child.accel.angular.along({0, 0, 1}) = u;
    if (torque)
      h.torque = w;
    else
      h.accel = w;
    d.output("y") = h.angle;
    return d;
  };
  const Error e = compile_error(scene(false));
  CHECK(says(e, Code::structure, {"h.accel"}));
  CHECK(has_names(e.mistakes().front().hint, {"h.torque", "h.accel"}));
  CHECK(compile_error(scene(true)).mistakes().empty());
}
