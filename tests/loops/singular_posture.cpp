#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "support/four_bar.hpp"
#include "support/notes.hpp"

/// Singular postures are distinguished from redundantly closed chains that still move.

using namespace titop;
using titop_test::FourBar;
using titop_test::parallelogram;

namespace {

/// True if the log warns of a singular posture: a warning on chains without the tolerance of their
/// rank.
bool warns(const System& system) {
  return titop_test::count_notes(system, Note::Kind::warning, "chains") >
         titop_test::count_notes(system, Note::Kind::warning, "chains", {"1e-09"});
}

bool warns(const FourBar& f) { return warns(compile(diagram(f))); }

}  // namespace

TEST_CASE("a four-bar linkage folded flat: the log warns of extra degrees of freedom") {
  CHECK(warns(parallelogram(0)));
  CHECK(warns(parallelogram(1e-12)));
  // Both angles by themselves, to first order: parallel or against each other from there.
  CHECK(compile(diagram(parallelogram(0))).order() == 4);
}

TEST_CASE("elsewhere it is closed twice out of its plane, and moves: no warning") {
  for (const double angle : {1e-3, 0.1, 0.7, 2.0}) {
    CAPTURE(angle);
    CHECK_FALSE(warns(parallelogram(angle)));
    CHECK(compile(diagram(parallelogram(angle))).order() == 2);
  }
  // Crank and coupler in one line stop the rocker, not the crank: a dead point is not singular.
  CHECK_FALSE(warns({0.3, 0.5, 0.6, 0, std::numbers::pi / 2, {0.8, -0.6, 0}}));
}

TEST_CASE("a door on two hinges in one line, held off that line: no warning") {
  Diagram d{"door"};
  const Vector3d z(0, 0, 1);
  auto base = d.add("base", RigidBody{.children = {{"A"}, {"D", {0.5, 0, 1}}}});
  ground(base);
  auto door = d.add(
      "door",
      RigidBody{.mass = 20, .inertia = {9, 5, 4}, .PA = {0.4, 0, 0.5}, .children = {{"C", z}}});
  auto arm =
      d.add("arm", RigidBody{.mass = 1, .inertia = {1, 1, 1}, .children = {{"C", {0.5, 0, 0}}}});
  auto lower = hinge(d, "lower", door, base.child("A"), Rotation(), z);
  lower.torque = d.input("u");
  hinge(d, "upper", arm, door.child, Rotation(), z).torque = 0;
  weld(arm.child, base.child("D"));
  d.output("angle") = lower.angle;
  const System system = compile(d);
  CHECK(system.order() == 2);
  CHECK(titop_test::noted(system, Note::Kind::info, "chains", {"5", "6"}));
  CHECK(!warns(system));
}

TEST_CASE("flexible bodies welded without a joint: the note names those without axial modes") {
  const auto frame = [](int kept) {
    const FlexibleBody beam = Beam{.length = 2,
                                   .section = rectangle(0.06, 0.04),
                                   .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                   .elements = 2,
                                   .modes = {.kept = kept}};
    const Rotation up = Rotation::about({0, 0, 1}, std::numbers::pi / 2);
    Diagram d{"frame"};
    auto base = d.add("base", RigidBody{.mass = 10, .children = {{"A"}, {"B", {2, 0, 0}}}});
    base.parent.force = -d.input("U", 6);
    auto left = d.add("left", beam), right = d.add("right", beam), top = d.add("top", beam);
    mount(left, base.child("A"), up);
    mount(right, base.child("B"), up);
    mount(top, left.child, up.inverse());
    weld(top.child, right.child, up.inverse());
    d.output("a", 6) = top.parent.accel;
    return compile(d);
  };
  const auto names_axial = [](const System& system) {
    return titop_test::noted(system, Note::Kind::warning, "chains", {"left", "right", "top"});
  };
  const System bending = frame(2);
  CHECK(names_axial(bending));
  CHECK_FALSE(warns(frame(12)));  // axial modes among them
  CHECK_FALSE(names_axial(compile(diagram(parallelogram(0)))));
}
