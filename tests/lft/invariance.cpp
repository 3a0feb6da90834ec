#include <doctest/doctest.h>

#include <titop/titop.hpp>

/// The same structure told in other ways: with another body as its root.

using namespace titop;

namespace {

const Vector3d kSite(0.7, 0.4, -0.3), kHubCentre(0.1, -0.2, 0.3), kArmCentre(0.5, 0.2, -0.1);
const Vector3d kHubInertia(5, 6, 7), kArmInertia(2, 3, 4);

struct Told {
  Diagram d;
  Param m, tilt, arm;
  explicit Told(const char* name)
      : d(name), m(d.param("m", 9)), tilt(d.param("tilt", 0.3)), arm(d.param("arm", 3)) {}
};

/// The hub's point O is free; the arm hangs at `kSite`, tilted.
System from_hub() {
  Told t{"from hub"};
  auto hub = t.d.add("hub", RigidBody{.mass = t.m,
                                      .inertia = kHubInertia.asDiagonal(),
                                      .PA = kHubCentre,
                                      .children = {{"site", kSite}}});
  auto arm = t.d.add(
      "arm", RigidBody{.mass = t.arm, .inertia = kArmInertia.asDiagonal(), .PA = kArmCentre});
  hub.parent.force = -t.d.input("U", 6);
  mount(arm, hub.child, Rotation::about({1, 0, 0}, t.tilt));
  t.d.output("y", 6) = hub.parent.accel;
  return compile(t.d);
}

/// The arm's root is free; the hub hangs there by its site, and its point O is a child.
System from_arm() {
  Told t{"from arm"};
  auto arm = t.d.add("arm", RigidBody{.mass = t.arm,
                                      .inertia = kArmInertia.asDiagonal(),
                                      .PA = kArmCentre,
                                      .children = {{"root", {0, 0, 0}}}});
  auto hub = t.d.add("hub", RigidBody{.mass = t.m,
                                      .inertia = kHubInertia.asDiagonal(),
                                      .PA = kHubCentre - kSite,
                                      .children = {{"O", -kSite}}});
  arm.parent.force = 0;
  mount(hub, arm.child, Rotation::about({1, 0, 0}, -1 * t.tilt));
  hub.child.force = t.d.input("U", 6);
  t.d.output("y", 6) = hub.child.accel;
  return compile(t.d);
}

}  // namespace

TEST_CASE("counts and transfers do not depend on which body is the root") {
  const ParameterRanges ranges = {
      {"m", percent(40)}, {"tilt", between(-2.5, 3)}, {"arm", percent(40)}};
  const Lft a = lft(from_hub(), ranges), b = lft(from_arm(), ranges);
  INFO(to_string(a), to_string(b));
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(a.deltas()[i].size == (i == 1 ? 8 : 3));
    CHECK(b.deltas()[i].size == a.deltas()[i].size);
    CHECK(a.deltas()[i].minimal());
    CHECK(b.deltas()[i].minimal());
  }
  const std::vector<ParameterList> values = {{{"m", 7}, {"tilt", -2.4}, {"arm", 2}},
                                             {{"m", 12}, {"tilt", 2.9}, {"arm", 4}}};
  const auto A = a.transfers(1, values), B = b.transfers(1, values);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK((A[i] - B[i]).norm() <= 1e-12 * A[i].norm());
    CHECK((A[i] - a.at(values[i]).transfer(1)).norm() <= 1e-13 * A[i].norm());
  }
}
