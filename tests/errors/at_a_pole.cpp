#include <doctest/doctest.h>
#include <fmt/format.h>

#include <limits>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

/// A pole of the system is refused, and one that only a block has by the name of its node; a soft
/// spring is no pole.

using namespace titop;
using titop_test::error_of;
using titop_test::says;

namespace {

/// A motion that is free by cancellation, not by structure: the rate of the last mass, less h times
/// its own integral, drives both that integral and the mass. A = 0 for these after rounding is
/// cleared.
Diagram free_by_cancellation(double h, double k) {
  Diagram d{"free"};
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = k, .damping = 1});
  auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 0, .damping = 2, .parent_mass = 1});
  auto c = d.add("c", SpringMass{.mass = 1, .stiffness = 0, .damping = 1, .parent_mass = 1});
  auto I = d.add("I", Integrator{});
  a.parent.force = -u;
  mount(b, a.child);
  mount(c, b.child);
  I.in = 1.0 * c.child.rate - h * I.out;
  c.child.force = 1.0 * c.child.rate - h * I.out;
  d.output("v") = c.child.rate;
  return d;
}

/// Masses in a row on a soft spring.
Diagram row_on_a_soft_spring(double soft, int n) {
  Diagram d{"row"};
  auto u = d.input("u");
  auto z = d.add("z1", SpringMass{.mass = 1, .stiffness = soft});
  ground(z);
  for (int i = 2; i <= n; ++i) {
    auto next = d.add(fmt::format("z{}", i), SpringMass{.mass = 1 + 0.1 * i, .stiffness = 1});
    mount(next, z.child);
    z = next;
  }
  z.child.force = u;
  d.output("x") = z.position;
  return d;
}

/// A hinge held by a torque law on its own angle.
Diagram held_hinge() {
  Diagram d{"held"};
  auto hub =
      d.add("hub", RigidBody{.mass = 8, .inertia = {3, 2, 4}, .children = {{"N", {0, 1, 0}}}});
  auto wing = d.add("wing", RigidBody{.mass = 1, .inertia = {1, 1, 1}, .PA = {0, 1, 0}});
  auto h = hinge(d, "drive", wing, hub.child("N"), {}, {0, 1, 0});
  h.torque = 50 * h.angle + 3 * h.rate - d.input("torque");
  hub.parent.accel = 0;
  d.output("angle") = h.angle;
  return d;
}

}  // namespace

TEST_CASE("static gain: a pole at 0 is refused where rounding has left something of it") {
  for (const double h : {0.21, 0.25, 0.4, 0.7, 1.3})
    for (const double k : {0.6, 1.0, 3.0}) {
      CAPTURE(h);
      CAPTURE(k);
      const System system = compile(free_by_cancellation(h, k));
      CHECK(says(error_of([&] { return system.static_gain(); }), Code::singular, {"s = 0"}));
      // Near it there is a value: a pole of order one.
      const double at = std::abs(system.transfer(1e-7)(0, 0)),
                   nearer = std::abs(system.transfer(1e-9)(0, 0));
      CHECK(std::abs(nearer / at / 100 - 1) <= 1e-3);
    }
}

TEST_CASE("static gain: a soft spring is no pole, however soft beside the others") {
  for (const double soft : {1e-3, 1e-9, 1e-12, 1e-15, 1e-18}) {
    CAPTURE(soft);
    const int n = 8;
    const System system = compile(row_on_a_soft_spring(soft, n));
    const double exact = 1 / soft + (n - 1);
    CHECK(std::abs(system.static_gain()(0, 0) / exact - 1) <= 1e-14);
    CHECK(std::abs(system.state_space().transfer(0)(0, 0) / exact - 1.0) <= 1e-14);
  }
}

TEST_CASE("at a pole of a block: the node is named, and the way out has a value") {
  const System held = compile(held_hinge());
  for (const Precision p : {Precision::standard, Precision::as_needed, Precision::refined,
                            Precision::twofold, Precision::digits50})
    CHECK(says(error_of([&] { return held.transfer(0, p); }), Code::singular,
               {"drive", "Hinge", "s = 0", "System::state_space().transfer(s)"}));
  const std::vector<double> omega{0, 1};
  CHECK(says(error_of([&] { return held.frequency_response(omega); }), Code::singular,
             {"drive", "s = 0"}));
  CHECK(std::abs(held.state_space().transfer(0)(0, 0) - 0.02) <= 1e-15);
}

TEST_CASE("at an s that is no number: not-finite, not a pole") {
  const System system = compile(row_on_a_soft_spring(1, 2));
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   infinity = std::numeric_limits<double>::infinity();
  for (const double omega : {nan, infinity, -infinity}) {
    const std::complex<double> s(0, omega);
    const std::string size = fmt::format("{}j", std::abs(omega));
    for (const Precision p : {Precision::standard, Precision::as_needed, Precision::refined,
                              Precision::twofold, Precision::digits50})
      CHECK(says(error_of([&] { return system.transfer(s, p); }), Code::not_finite,
                 {"row", "s = 0", size}));
    CHECK(says(error_of([&] { return system.frequency_response(std::vector{omega}); }),
               Code::not_finite, {"row", "s = 0", size}));
    CHECK(says(error_of([&] { return system.state_space().transfer(s); }), Code::not_finite,
               {"s = 0", size}));
  }
}
