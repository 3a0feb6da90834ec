#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "simulation/scenes.hpp"
#include "support/notes.hpp"
#include "support/rng.hpp"

/// The certificate that every compile makes: no warning if nothing is wrong.

using namespace titop;
using titop_test::outputs_lose_digits;

namespace {

bool warns(const System& system) {
  return std::ranges::any_of(system.notes(),
                             [](const Note& n) { return n.kind == Note::Kind::warning; });
}

/// Four beams in a row, free, data and model in this unit of length.
System beams(double length) {
  const FlexibleBody beam(
      titop::scaled(titop::modal_data(Beam{.length = 2.0,
                                           .section = rectangle(0.06, 0.04),
                                           .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                           .elements = 4,
                                           .modes = {.kept = 6, .xi = {0.005}}}),
                    {.length = length}));
  Diagram d{"beams"};
  auto U = d.input("U", 6);
  std::vector<FlexibleBody::Handle> b;
  b.reserve(4);
  for (std::size_t i = 0; i < 4; ++i) {
    b.push_back(d.add(fmt::format("b{}", i + 1), beam));
    if (i > 0)
      mount(b[i], b[i - 1].child, Rotation::about({1, 2, 3}, 0.7 * static_cast<double>(i)));
  }
  b.front().parent.force = -U;
  d.output("a", 6) = b.back().child.accel;
  return compile(d, {.minimize_up_to = 0});
}

}  // namespace

TEST_CASE("a force that dies away along 3000 masses to less than the smallest double is no fault") {
  const std::vector<double> m(3000, 1.3), k(3000, 107);
  const System system = compile(simulation_test::row_of_masses(m, k, 0.1), {.minimize_up_to = 0});
  CHECK(system.certificate().residual <= 1e-12);
  CHECK(!warns(system));
}

TEST_CASE("margin and warnings do not depend on the unit of length, 1 nm to 1 Gm") {
  const double margin = beams(1).certificate().margin;
  CHECK(margin < 1e4);
  for (const double length : {1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9}) {
    CAPTURE(length);
    const System system = beams(length);
    CHECK(std::abs(system.certificate().margin / margin - 1) <= 0.01);
    CHECK(system.certificate().residual <= 1e-13);
    CHECK(!warns(system));
  }
}

namespace {

/// y = g (u + y).
System fed_back(double g) {
  Diagram d{"fed back"};
  auto G = d.add("G", Gain{.gain = g});
  G.in = d.input("u") + G.out;
  d.output("y") = G.out;
  return compile(d);
}

/// A mass on a spring, a force of it by a gain on its own motion.
template <class Reads>
System driven(Reads reads) {
  Diagram d{"driven"};
  auto z = d.add("z", SpringMass{.mass = 3, .stiffness = 100, .parent_mass = 2});
  z.parent.accel = 0;
  z.child.force = d.input("u") - 0.1 * reads(z.child);
  d.output("a") = z.child.accel;
  return compile(d);
}

}  // namespace

TEST_CASE("equations are checked at one instant, at some s where that is not enough") {
  CHECK(beams(1).certificate().at_instant);
  const auto accel = [](auto port) { return port.accel; };
  CHECK(driven(accel).certificate().at_instant);
  CHECK(driven(accel).certificate().residual <= 1e-15);
  for (const System& system : {driven([](auto port) { return port.rate; }),
                               driven([](auto port) { return port.position; })}) {
    CHECK(!system.certificate().at_instant);
    CHECK(system.certificate().residual <= 1e-15);
  }
  CHECK(fed_back(0.5).certificate().at_instant);
  CHECK(!warns(fed_back(0.5)));
  const System close = fed_back(1 - 0x1p-34);  // 6e-11 from singular
  CHECK(!close.certificate().at_instant);
  CHECK(outputs_lose_digits(close));
}

namespace {

/// Two spring-masses on a hub, pulled equally; the difference of their forces on the hub, as an
/// output or through a filter. `apart`: of their parent masses.
Diagram twins(double apart, bool filtered) {
  Diagram d{"twins"};
  auto u = d.input("u");
  auto hub = d.add("hub", RigidBody{.mass = 3, .children = {{"L"}, {"R"}}});
  auto left = d.add("left", SpringMass{.mass = 1.1, .stiffness = 70, .parent_mass = 0.3});
  auto right = d.add("right", SpringMass{.mass = 1.1, .stiffness = 70, .parent_mass = 0.3 + apart});
  hub.parent.force = -d.input("U", 6);
  mount(left, hub.child("L").along({1, 0, 0}));
  mount(right, hub.child("R").along({1, 0, 0}));
  left.child.force = u;
  right.child.force = u;
  const Expr difference = left.parent.force - right.parent.force;
  const auto one = Eigen::MatrixXd::Identity(1, 1);
  auto K = d.add("K", Lti{.A = -one, .B = one, .C = one});
  K.in = difference;
  if (filtered)
    d.output("y") = K.out;
  else
    d.output("y") = difference;
  return d;
}

}  // namespace

TEST_CASE("an output that is 0 by symmetry has lost no digits, one that nearly cancels has") {
  for (const double apart : {0.0, 1e-11})
    for (const bool filtered : {false, true}) {
      CAPTURE(apart);
      CAPTURE(filtered);
      const System system = compile(twins(apart, filtered));
      CHECK(outputs_lose_digits(system) == (apart > 0));
      CHECK(system.certificate().at_instant == (apart == 0));
    }
}

TEST_CASE("a motion that decays along a long chain to rounding is no residual") {
  // Free booms, hinged and controlled: the motion of the root decays by tens of decades.
  titop_test::Rng random(5);
  const FlexibleBody boom = Beam{.length = 2.0,
                                 .section = rectangle(0.06, 0.04),
                                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                 .elements = 4,
                                 .modes = {.kept = 6, .xi = {0.005}}};
  for (int chain = 0; chain < 5; ++chain) {
    Diagram d{"chain"};
    auto U = d.input("U", 6);
    auto last = d.add("B1", boom);
    last.parent.force = -U;
    for (int i = 2; i <= 60; ++i) {
      const Vector3d axis = random.matrix(3, 1);
      auto next = d.add(fmt::format("B{}", i), boom);
      auto h = hinge(d, fmt::format("J{}", i), next, last.child,
                     Rotation::about(axis, random.between(0.1, 3)), {0, 0, 1});
      h.torque = 40 * h.angle + 8.0 * h.rate;
      last = next;
    }
    d.output("a", 6) = last.child.accel;
    CHECK(compile(d, {.minimize_up_to = 0}).certificate().residual <= 1e-12);
  }
}
