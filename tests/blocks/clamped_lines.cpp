#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/line_port.hpp>
#include <titop/compiler/system/system.hpp>
#include <vector>

#include "support/mistakes.hpp"
#include "support/notes.hpp"

/// Lines fixed to the ground and to rigid bodies: the clamped edge of a square plate. Lines as the
/// children of their bodies.

using namespace titop;
using titop_test::count_notes;
using titop_test::error_of;
using titop_test::says;

namespace {

/// Square plate of 8 x 8 elements whose frequencies are omega a^2 sqrt(rho h / D), nu = 0.3, with
/// its edge x0 as the line "root" and the point "tip" at x1.
FlexibleBody square(const std::string& parent, const std::string& child, int m = 4) {
  fe::Mesh mesh = plate_mesh({.a = 1,
                              .b = 1,
                              .thickness = 0.01,
                              .material = {.rho = 100},
                              .D = PlateStiffness{1, 0.3, 1, 0.35},
                              .elements = {8, 8}});
  mesh = fe::with_interface(mesh, "root", fe::shapes(fe::edge(mesh, "x0"), fe::legendre(m)));
  mesh = fe::with_interface(mesh, "tip", fe::average(fe::edge(mesh, "x1")));
  return fe::modal_data(mesh, parent, {child}, {.kept = 12, .residual = {parent, child}});
}

RigidBody hub() {
  return {.mass = 5, .inertia = 2 * Matrix3d::Identity(), .children = {{"C", Vector3d(0.3, 0, 0)}}};
}

/// The same elements in another program, clamped along x0.
void check_clamped(Diagram d, const DualPort<6>& tip) {
  tip.force += d.input("F", 6);
  d.output("a", 6) = tip.accel;
  const System system = compile(d);
  CHECK(count_notes(system, Note::Kind::warning, "check") == 0);
  std::vector<double> omega;
  for (const Pole& pole : system.poles())
    if (pole.omega > 0) omega.push_back(pole.omega);
  std::sort(omega.begin(), omega.end());
  const std::vector<double> expected = {3.47201, 8.50957, 21.29249};
  REQUIRE(omega.size() >= expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    INFO(omega[k], ", expected ", expected[k]);
    CHECK(std::abs(omega[k] - expected[k]) <= 1.5e-6 * expected[k]);
  }
}

}  // namespace

TEST_CASE("a parent that is a line, clamped along its whole length") {
  {
    Diagram d{"wall"};
    auto a = d.add("a", square("root", "tip"));
    ground(a.line("root"));
    check_clamped(std::move(d), a.child("tip"));
  }
  for (const bool welded : {false, true}) {
    Diagram d{"wall"};
    auto h = d.add("h", hub());
    auto a = d.add("a", square("root", "tip"));
    ground(h);
    if (welded)
      weld(a.line("root"), h.child("C"));
    else
      mount(a.line("root"), h.child("C"));
    check_clamped(std::move(d), a.child("tip"));
  }
}

TEST_CASE("the line of a child, welded to a rigid body, holds the plate") {
  Diagram d{"wall"};
  auto h = d.add("h", hub());
  auto a = d.add("a", square("tip", "root"));
  ground(h), release(a);
  weld(a.line("root"), h.child("C"));
  CHECK(says(error_of([&] { mount(a.line("root"), h.child("C")); }), Code::bad_value,
             {"a.root", "parent", "weld"}));
  check_clamped(std::move(d), a.parent);
}

TEST_CASE("the log warns of a parent's line that is held at its point alone") {
  const auto warnings = [](void (*hold)(Diagram&, const FlexibleBodyHandle&)) {
    Diagram d{"wall"};
    auto a = d.add("a", square("root", "tip"));
    hold(d, a);
    d.output("F", 6) = a.parent.reaction;
    return count_notes(compile(d), Note::Kind::warning, "check",
                       {"a:", "line root", "root.z2", "ground(a.line(\"root\"))"});
  };
  CHECK(warnings([](Diagram&, const FlexibleBodyHandle& a) { ground(a); }) == 1);
  CHECK(warnings([](Diagram& d, const FlexibleBodyHandle& a) {
          auto h = d.add("h", hub());
          ground(h), mount(a, h.child("C"));
        }) == 1);
  CHECK(warnings([](Diagram&, const FlexibleBodyHandle& a) { ground(a.line("root")); }) == 0);
  CHECK(warnings([](Diagram&, const FlexibleBodyHandle& a) {
          ground(a);
          for (const DualPort<1>& shape : a.line("root").shape_ports) release(shape);
        }) == 0);
  // A hinge of two polynomials ties no shape, and means it.
  CHECK(warnings([](Diagram& d, const FlexibleBodyHandle& a) {
          ground(a.line("root"));
          auto inner = d.add("inner", square("tip", "root", 2));
          auto outer = d.add("outer", square("root", "tip", 2));
          ground(inner);
          auto hinge = hinge_line(d, "hinge", outer.line("root"), inner.line("root"));
          hinge.torque = 0;
        }) == 0);
}

TEST_CASE("the log warns of a child's line that is held at its point alone") {
  const auto warnings = [](void (*hold)(Diagram&, const FlexibleBodyHandle&)) {
    Diagram d{"wall"};
    auto a = d.add("a", square("tip", "root"));
    release(a);
    hold(d, a);
    d.output("a", 6) = a.parent.accel;
    return count_notes(compile(d), Note::Kind::warning, "check",
                       {"a:", "child", "line root", "root.z2", "weld(a.line(\"root\")"});
  };
  CHECK(warnings([](Diagram&, const FlexibleBodyHandle& a) { ground(a.child("root")); }) == 1);
  CHECK(warnings([](Diagram& d, const FlexibleBodyHandle& a) {
          auto b = d.add("b", square("tip", "root"));
          ground(b), weld(a.child("root"), b.child("root"));
        }) == 1);
  CHECK(warnings([](Diagram& d, const FlexibleBodyHandle& a) {
          auto b = d.add("b", square("tip", "root"));
          ground(b), weld(a.line("root"), b.line("root"));
        }) == 0);
  CHECK(warnings([](Diagram&, const FlexibleBodyHandle& a) { ground(a.line("root")); }) == 0);
  CHECK(warnings([](Diagram& d, const FlexibleBodyHandle& a) {
          a.child("root").force += d.input("F", 6);
        }) == 0);
}

TEST_CASE(
    "a body whose only child is a line: child is that point, and no shape has a child's name") {
  Diagram d{"wall"};
  auto a = d.add("a", square("tip", "root"));
  ground(a);
  a.child.force += d.input("F", 6);
  d.output("by_name", 6) = a.child("root").accel;
  d.output("alone", 6) = a.child.accel;
  const Eigen::MatrixXcd both = compile(d).transfer({0.1, 5});
  CHECK(both.topRows(6) == both.bottomRows(6));
  CHECK(both.norm() > 0);
  a.child("root.z2").force += d.input("G", 6);
  const Error unknown = titop_test::compile_error(d);
  CHECK(says(unknown, Code::unknown_name, {"a", "root.z2", "its child points are: root"}));
  CHECK_FALSE(says(unknown, Code::unknown_name, {"root.z3"}));
}
