#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/titop.hpp>

#include "support/growth.hpp"

/// Diagrams of many parts: processor time grows with their number, not with its square.

using namespace titop;
using titop_test::growth;
using titop_test::kNearlyLinear;

namespace {

/// A mass on a wall with n others on springs, each stiffness a parameter.
Diagram star(int n) {
  Diagram d{"star"};
  auto hub = d.add("hub", SpringMass{.mass = 5, .stiffness = 7});
  ground(hub);
  for (int i = 0; i < n; ++i) {
    const auto k = d.param(fmt::format("k{}", i), 10.0 + i % 3);
    mount(d.add(fmt::format("z{}", i), SpringMass{.mass = 1, .stiffness = k}), hub.child);
  }
  hub.child.force += d.input("u");
  d.output("x") = hub.stretch;
  return d;
}

std::complex<double> star_by_hand(int n, std::complex<double> s) {
  std::complex<double> Z = 5.0 * s * s + 7.0;
  for (int i = 0; i < n; ++i) {
    const double k = 10.0 + i % 3;
    Z += k * s * s / (s * s + k);
  }
  return 1.0 / Z;
}

Diagram many_signs(int n) {
  Diagram d{"sum"};
  const auto u = d.input("u");
  std::string signs(static_cast<std::size_t>(n), '+');
  for (std::size_t i = 0; i < signs.size(); i += 3) signs[i] = '-';
  auto sum = d.add("sum", Sum{.signs = signs});
  for (int i = 1; i <= n; ++i) sum.in(i) = u;
  d.output("y") = sum.out;
  return d;
}

Diagram many_outputs(int n) {
  Diagram d{"outputs"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 8});
  ground(z);
  z.child.force = d.input("u");
  for (int i = 0; i < n; ++i) d.output(fmt::format("y{}", i)) = (1.0 + i) * z.stretch;
  return d;
}

}  // namespace

TEST_CASE("large diagrams: a star of many parameters and terms is read in linear time") {
  CHECK(growth(1000, [](int n) {
          return [text = diagram_json(star(n))] { parse_diagram(text); };
        }) <= kNearlyLinear);
  const std::complex<double> s(0.3, 2.1), x = star_by_hand(1000, s);
  CHECK(std::abs(compile(parse_diagram(diagram_json(star(1000)))).transfer(s)(0, 0) - x) <=
        1e-12 * std::abs(x));
}

TEST_CASE("large diagrams: a sum of many signs is added, compiled and evaluated in linear time") {
  CHECK(growth(1500, [](int n) { return [n] { compile(many_signs(n)).transfer(1); }; }) <=
        kNearlyLinear);
  CHECK(compile(many_signs(1500)).transfer(1)(0, 0) == 500.0);
}

TEST_CASE("large diagrams: certificate and report of many outputs take linear time") {
  CHECK(growth(125, [](int n) {
          return [n] { CHECK(certify(compile(many_outputs(n))).holds()); };
        }) <= kNearlyLinear);
  CHECK(growth(125, [](int n) { return [n] { report_html(compile(many_outputs(n))); }; }) <=
        kNearlyLinear);
}
