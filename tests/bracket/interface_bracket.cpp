#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>
#include <titop/analysis/bracket/interface_bracket.hpp>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <vector>

#include "support/mistakes.hpp"
#include "support/names.hpp"

/// interface_bracket: two halves of a plate against the whole, and mistakes.

using namespace titop;
using titop_test::error_of;
using titop_test::has_names;
using titop_test::says;

namespace {

/// A plate whose frequencies are omega a^2 sqrt(rho h / D), nu = 0.3.
fe::Mesh plate(double a, int along_x) {
  return plate_mesh({.a = a,
                     .b = 1,
                     .thickness = 0.01,
                     .material = {.rho = 100},
                     .D = PlateStiffness{1, 0.3, 1, 0.35},
                     .elements = {along_x, 6}});
}

fe::Mesh held(const fe::Mesh& mesh) {
  return fe::with_interface(mesh, "root", fe::rigid(fe::edge(mesh, "x0")));
}

/// 20 modes and residual vectors of its ports: the frequencies that are compared change by less
/// than 1e-6.
FlexibleBody body(const fe::Mesh& mesh, const std::string& parent, const std::string& child) {
  return fe::modal_data(mesh, parent, {child}, {.kept = 20, .residual = {parent, child}});
}

/// Loads and sensors at the same place in all models: a corner.
constexpr const char* kTip = "4,6";

void load(Diagram& d, const DualPort<6>& tip) {
  tip.force += d.input("F", 6);
  d.output("x", 6) = tip.position;
}

Diagram whole() {
  Diagram d{"whole"};
  auto panel = d.add("whole", body(held(plate(1, 8)), "root", "8,6"));
  ground(panel);
  load(d, panel.child);
  return d;
}

Diagram halves(Lumping lumping, int m) {
  const auto line = [&](const fe::Mesh& mesh, const std::string& edge) {
    return lumping == Lumping::constrained ? fe::shapes(fe::edge(mesh, edge), fe::legendre(m))
                                           : fe::moments(fe::edge(mesh, edge), fe::legendre(m));
  };
  fe::Mesh a = held(plate(0.5, 4)), b = plate(0.5, 4);
  a = fe::with_interface(a, "next", line(a, "x1"));
  b = fe::with_interface(b, "prev", line(b, "x0"));
  Diagram d{"halves"};
  auto inner = d.add("inner", body(a, "root", "next"));
  auto outer = d.add("outer", body(b, "prev", kTip));
  ground(inner);
  weld(outer.line("prev"), inner.line("next"));
  load(d, outer.child(kTip));
  return d;
}

}  // namespace

TEST_CASE("two halves of a plate enclose the whole") {
  // The same elements in another program, by m = 3 polynomials, and without a cut.
  const std::vector<double> below = {3.471702988, 8.230923515, 21.265996347, 27.026626056};
  const std::vector<double> above = {3.473561051, 8.514202979, 21.299291137, 28.214040292};
  const std::vector<double> exact = {3.472102693, 8.510327217, 21.293861534, 27.208952530};
  const std::vector<double> band = {1, 2, 3};
  const InterfaceBracket b =
      interface_bracket([](Lumping l) { return halves(l, 3); },
                        {.modes = 4, .compliances = {{2, 2}, {3, 3}}, .omega = band});
  REQUIRE(b.omega.size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(std::abs(b.omega[k].below / below[k] - 1) <= 1e-6);
    CHECK(std::abs(b.omega[k].above / above[k] - 1) <= 1e-6);
    CHECK(b.omega[k].below <= exact[k]);
    CHECK(b.omega[k].above >= exact[k]);
  }
  const System uncut = compile(whole());
  const Eigen::MatrixXd gain = uncut.static_gain();
  REQUIRE(b.compliance.size() == 2);
  for (const auto& [k, component] : {std::pair{0, 2}, {1, 3}}) {
    const InterfaceBracket::Interval& i = b.compliance[std::size_t(k)];
    CHECK(i.below < gain(component, component));
    CHECK(i.above > gain(component, component));
    CHECK(i.width() <= 0.04 * i.above);
  }
  CHECK(b.transfer_difference > 0);
  CHECK(b.transfer_difference <= 0.2);
  CHECK(interface_bracket([](Lumping l) { return halves(l, 5); }, {.omega = band})
            .transfer_difference < b.transfer_difference);
  const std::string first = fmt::format("{:.7g}", below[0] / (2 * std::numbers::pi));
  CHECK(has_names(to_string(b), {first, "Hz", "compliance"}));
}

TEST_CASE("scenes that cannot be compared are refused") {
  const auto refused = [](const std::function<Diagram(Lumping)>& scene,
                          const BracketOptions& options = {}) {
    return error_of([&] { interface_bracket(scene, options); });
  };
  const auto same = [](Lumping) { return whole(); };
  CHECK(says(refused(same, {.modes = 3, .omega = {2.0, 5.0}}), Code::bad_value,
             {"constrained", "released", "fe::average"}));
  CHECK(says(refused(same, {.modes = 1000}), Code::bad_value, {"1000"}));
  CHECK(says(refused(same, {.compliances = {{2, 6}}}), Code::bad_value, {"input 2", "output 6"}));
  CHECK(says(refused([](Lumping l) {
               Diagram d = whole();
               if (l == Lumping::released) d.input("more");
               return d;
             }),
             Code::bad_value, {"6 inputs", "7"}));
  CHECK(says(refused([](Lumping l) {
               if (l == Lumping::constrained) return whole();
               Diagram d{"free"};
               auto loose = d.add("whole", body(held(plate(1, 8)), "root", "8,6"));
               loose.parent.force = 0;
               load(d, loose.child);
               return d;
             }),
             Code::bad_value, {"without stiffness"}));
}
