#include <doctest/doctest.h>

#include <string>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/line_port.hpp>
#include <titop/compiler/system/system.hpp>

#include "panels.hpp"
#include "support/mistakes.hpp"

/// Lines of bodies that do not fit each other, or that their modes do not move.

using namespace titop;
using namespace panels;
using titop_test::error_of;
using titop_test::says;

namespace {

FlexibleBody body(const fe::Mesh& mesh, const std::string& parent, const std::string& child) {
  return fe::modal_data(mesh, parent, {child});
}

}  // namespace

TEST_CASE("lines that do not fit are refused, with both") {
  fe::Mesh other = panel(0.5, 2, 3);
  other = fe::with_interface(other, "few", fe::shapes(fe::edge(other, "x0"), fe::legendre(3)));
  other = fe::with_interface(other, "part",
                             fe::shapes(fe::segment(other, "x1", 0, 2.0 / 3), fe::legendre(3)));
  fe::Mesh along = panel(0.6, 3, 2);
  along = fe::with_interface(along, "prev", shapes(along, "y0"));
  Diagram d{"wing"};
  auto a = d.add("a", body(inner(), "root", "next"));
  auto b = d.add("b", body(other, "few", "part"));
  auto c = d.add("c", FlexibleBody{fe::modal_data(along, "prev", {})});
  auto e = d.add("e", FlexibleBody{fe::modal_data(along, "prev", {})});
  const auto refused = [&](const LinePort& from, const LinePort& to, const Rotation& T = {}) {
    return error_of([&] { weld(from, to, T); });
  };
  CHECK(says(refused(b.line("few"), a.line("next")), Code::size, {"b.few", "z2", "a.next", "z3"}));
  CHECK(says(refused(b.line("part"), b.line("few")), Code::bad_value, {"b.part", "0.4", "0.6"}));
  CHECK(says(refused(c.line("prev"), a.line("next")), Code::size, {"along x", "along y"}));
  CHECK(says(refused(c.line("prev"), a.line("next"), Rotation::about({0, 0, 1}, 1)),
             Code::bad_value, {"c.prev", "a.next", "parallel"}));
  CHECK(
      says(refused(c.line("prev"), a.line("next"), Rotation::about({0, 0, 1}, d.param("tilt", 1))),
           Code::bad_value, {"c.prev", "parameters"}));
  CHECK(says(refused(c.line("prev"), e.line("prev")), Code::bad_value, {"c.prev", "e.prev"}));
  CHECK(says(error_of([&] { hinge_line(d, "h", a.line("next"), a.line("next")); }), Code::bad_value,
             {"a.next", "h"}));
  CHECK(says(error_of([&] { a.line("root"); }), Code::unknown_name, {"a", "root", "next"}));
  CHECK(says(error_of([&] {
               a.line("next").shape({2, 9});
             }),
             Code::unknown_name, {"a.next", "z9", "z2"}));
  CHECK(says(error_of([&] {
               a.line("next").shape({9, 1});
             }),
             Code::unknown_name, {"a.next", "component 9", "z2"}));
  ModalData wrong = fe::modal_data(along, "prev", {});
  wrong.lines[0].Phi.conservativeResize(4, Eigen::NoChange);
  CHECK(says(error_of([&] { FlexibleBody{wrong}; }), Code::bad_modes, {"prev", "4", "5"}));
  wrong = fe::modal_data(along, "prev", {});
  wrong.lines[0].shapes[0].degree = 1;  // z1 is the rotation of the point
  CHECK(says(error_of([&] { FlexibleBody{wrong}; }), Code::bad_value, {"prev", "z1", "rx"}));
  wrong = fe::modal_data(along, "prev", {});
  wrong.lines[0].axis = 3;
  CHECK(says(error_of([&] { FlexibleBody{wrong}; }), Code::bad_value, {"prev", "none of x, y, z"}));
}

TEST_CASE("one line may be the parent's, all others have the name of a child") {
  fe::Mesh mesh = panel(0.5, 2, 3);
  mesh = fe::with_interface(mesh, "prev", shapes(mesh, "x0"));
  mesh = fe::with_interface(mesh, "next", shapes(mesh, "x1"));
  ModalData data = fe::modal_data(mesh, "prev", {"next"});
  CHECK(error_of([&] { FlexibleBody{data}; }).mistakes().empty());
  for (ModalLine& line : data.lines)
    if (line.name == "next") line.name = "nxet";
  CHECK(says(error_of([&] { FlexibleBody{data}; }), Code::unknown_name, {"prev", "nxet", "next"}));
}

TEST_CASE("a shape that the kept modes move by rounding alone is refused") {
  // The lowest mode of a square plate clamped along x0 is even in y, the rotation ry1 of x1 is odd.
  fe::Mesh mesh = panel(0.6, 8, 8);
  mesh = fe::with_interface(mesh, "root", fe::rigid(fe::edge(mesh, "x0")));
  mesh = fe::with_interface(mesh, "next", fe::moments(fe::edge(mesh, "x1"), fe::legendre(2)));
  Diagram d{"wing"};
  auto a = d.add("a", FlexibleBody{fe::modal_data(mesh, "root", {"next"}, {.kept = 1})});
  ground(a);
  const DualPort<1> shape = a.line("next").shape({4, 1});
  shape.accel = d.input("u");
  d.output("f") = shape.reaction;
  CHECK(says(titop_test::compile_error(d), Code::improper, {"a", "next.ry1"}));
}

TEST_CASE("a shape that no mode moves is refused by name, locked and driven") {
  const fe::ModeOptions none{.kept = 0};
  const auto refused = [](const ModalData& data, bool driven) {
    Diagram d{"wing"};
    auto a = d.add("a", FlexibleBody{data});
    ground(a);
    const DualPort<1> shape = a.line("next").shape({2, 2});
    if (driven)
      shape.accel = d.input("u");
    else
      shape.accel = 0;
    d.output("f") = shape.reaction;
    a.child("next").force += d.input("F", 6);
    return titop_test::compile_error(d);
  };
  const ModalData still = fe::modal_data(inner(), "root", {"next"}, none);
  CHECK(says(refused(still, false), Code::kinematic_loop, {"a", "next.z2"}));
  CHECK(says(refused(still, true), Code::improper, {"a", "next.z2"}));
}
