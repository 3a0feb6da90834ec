#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes.hpp"
#include "support/mistakes.hpp"

/// The automatic stepper reports its accuracy.

using namespace titop;
using namespace simulation_test;
using titop_test::error_of;
using titop_test::has_name;
using titop_test::says;

namespace {

/// n masses of 1 kg in a row on springs of 100 N/m, a force on the last.
System row_of(int n) {
  std::vector<double> mass(static_cast<std::size_t>(n), 1.0), stiffness(mass.size(), 100.0);
  return compile(row_of_masses(mass, stiffness));
}

/// Operations of the exact step, as a refusal names them where it sends there.
std::string cost_of_exact(const System& s) { return fmt::format("{0} x {0} x {0}", s.order()); }

}  // namespace

TEST_CASE("up to 600 states the choice is exact, and its error is rounding") {
  const System s = row_of(300);
  const Trajectory t =
      simulate(s, Excitation::step(Eigen::VectorXd::Ones(1)), {.step = 0.5, .until = 1});
  CHECK(t.stepper == Stepper::exact);
  REQUIRE(t.error.size() == 300);
  CHECK(t.error.maxCoeff() < 1e-10);
}

/// A wall, a light mass on a stiff spring, a heavy one on another; the heavy one is pushed by its
/// weight in newtons, and follows the deflection of the two springs at its own low frequency.
System heavy_on_light(double heavy) {
  Diagram d{"heavy on light"};
  auto light = d.add("light", SpringMass{.mass = 1, .stiffness = 1e6});
  auto load = d.add("load", SpringMass{.mass = heavy, .stiffness = 2e6});
  light.parent.accel = 0;
  load.parent.accel = light.child.accel;
  light.child.force = load.parent.force;
  load.child.force = heavy * d.input("u");
  d.output("x") = light.stretch + load.stretch;
  return compile(d);
}

TEST_CASE("if A has lost the digits of slow motion, the exact step reports it and is not chosen") {
  const double heavy = 1e16, soft = 1 / (1 / 1e6 + 1 / 2e6), slow = std::sqrt(soft / heavy);
  const System s = heavy_on_light(heavy);
  const Excitation push = Excitation::step(Eigen::VectorXd::Ones(1));
  const double step = 2e-3 / slow, until = 5000 * step;  // 1.6 periods
  const auto off = [&](const Trajectory& t) {            // the light mass alone changes it by 1e-16
    double worst = 0;
    for (std::size_t k = 0; k < t.time.size(); ++k) {
      const double x = heavy / soft * (1 - std::cos(slow * t.time[k]));
      worst = std::max(worst, std::abs(t.y(0, static_cast<Eigen::Index>(k)) - x));
    }
    return worst / (2 * heavy / soft);
  };
  const Trajectory exact =
      simulate(s, push, {.step = step, .until = until, .stepper = Stepper::exact});
  CHECK(off(exact) > 0.01);
  CHECK(exact.error(0) > off(exact) / 3);
  CHECK(exact.error(0) < off(exact) * 3);
  const Trajectory t = simulate(s, push, {.step = step, .until = until});
  CHECK(t.stepper == Stepper::midpoint);
  CHECK(off(t) < 1e-5);
  CHECK(t.error(0) < 1e-4);
}

TEST_CASE("an output that symmetry makes 0 takes nobody away from the exact step") {
  Diagram d{"boom"};
  auto hub = d.add("hub", RigidBody{.mass = 400,
                                    .inertia = Eigen::Vector3d(80, 90, 100).asDiagonal(),
                                    .children = {{"C", {1, 0, 0}}}});
  const FlexibleBody rod = Beam{.length = 8,
                                .section = rectangle(0.05, 0.05),
                                .material = {.E = 70e9, .nu = 0.33, .rho = 2700}};
  auto boom = d.add("boom", rod);
  mount(boom, hub.child("C"));
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -d.input("torque", 3);
  d.output("attitude", 3) = hub.parent.position.angular();
  d.output("tip") = boom.child.accel.along({0, 1, 0});
  const Trajectory t =
      simulate(compile(d), Excitation::step(Eigen::Vector3d(0, 0, 1)), {.step = 0.1, .until = 60});
  CHECK(t.stepper == Stepper::exact);
  CHECK(t.error(2) < 1e-9);  // about the axis that turns
  CHECK(t.error(3) < 1e-9);
}

TEST_CASE("a slow mode that grows in A alone is no reason to call the system unstable") {
  Diagram d{"row"};  // stiffnesses that are no round numbers: rounding moves the slow pole
  auto light = d.add("light", SpringMass{.mass = 1, .stiffness = 1.1e6 / 3});
  auto load = d.add("load", SpringMass{.mass = 1e19, .stiffness = 2.3e6 / 7});
  light.parent.accel = 0;
  load.parent.accel = light.child.accel;
  light.child.force = load.parent.force;
  load.child.force = 1e19 * d.input("u");
  d.output("x") = light.stretch + load.stretch;
  const System s = compile(d);
  const double soft = 1 / (3 / 1.1e6 + 7 / 2.3e6), slow = std::sqrt(soft / 1e19);
  const Trajectory t = simulate(s, Excitation::step(Eigen::VectorXd::Ones(1)),
                                {.step = 1e-2 / slow, .until = 10 / slow});
  CHECK(t.stepper == Stepper::midpoint);
  for (const std::size_t k : {std::size_t{100}, std::size_t{500}, std::size_t{1000}}) {
    const double x = 1e19 / soft * (1 - std::cos(slow * t.time[k]));
    CHECK(std::abs(t.y(0, static_cast<Eigen::Index>(k)) - x) < 1e-3 * 2e19 / soft);
  }
}

TEST_CASE("where both lose too much, the refusal does not send to the exact step") {
  const double slow = std::sqrt(1 / (1 / 1e6 + 1 / 2e6) / 1e16);
  const System s = heavy_on_light(1e16);
  const Error error = error_of([&] {
    simulate(s, Excitation::step(Eigen::VectorXd::Ones(1)), {.step = 1 / slow, .until = 20 / slow});
  });
  CHECK(says(error, Code::bad_value, {"Stepper::exact"}));
  CHECK(!has_name(error.what(), cost_of_exact(s)));
}

TEST_CASE(
    "beyond, midpoint at half the step: the error is told, and is about three times the true one") {
  const System s = row_of(310);
  const Excitation push =
      Excitation::function([](double time) { return Eigen::VectorXd::Constant(1, 1 + time); });
  // Far from the push nothing has arrived by then: of that, no digit is right.
  const Trajectory t = simulate(s, push, {.step = 0.01, .until = 2, .accuracy = HUGE_VAL});
  CHECK(t.stepper == Stepper::midpoint);
  const Trajectory half =
      simulate(s, push, {.step = 0.005, .until = 2, .stepper = Stepper::midpoint});
  const Trajectory exact = simulate(s, push, {.step = 0.01, .until = 2, .stepper = Stepper::exact});
  CHECK(half.error.size() == 0);
  const Eigen::Index last = 309;  // of the mass that is pushed
  double off = 0, size = 0;
  for (Eigen::Index k = 0; k <= 200; ++k) {
    CHECK(std::abs(t.y(last, k) - half.y(last, 2 * k)) <= 1e-12 * std::abs(half.y(last, 2 * k)));
    off = std::max(off, std::abs(t.y(last, k) - exact.y(last, k)));
    size = std::max(size, std::abs(exact.y(last, k)));
  }
  CHECK(t.error(last) >= 2.5 * off / size);  // h^2: (4 - 1) times
  CHECK(t.error(last) <= 3.5 * off / size);
}

TEST_CASE("beyond, steps that are too long are refused, with the output and the way out") {
  const System s = row_of(310);
  const Excitation push = Excitation::step(Eigen::VectorXd::Ones(1));
  const Error error = error_of([&] { simulate(s, push, {.step = 1, .until = 10}); });
  CHECK(std::ranges::any_of(s.outputs(), [&](const std::string& output) {
    return says(error, Code::bad_value, {"1 s", output, "Stepper::exact", cost_of_exact(s)});
  }));
  const Trajectory t = simulate(s, push, {.step = 1, .until = 10, .accuracy = HUGE_VAL});
  CHECK(t.error.maxCoeff() > 0.01);
}
