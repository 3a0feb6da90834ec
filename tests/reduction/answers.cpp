#include <doctest/doctest.h>
#include <fmt/format.h>

#include "scenes.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"

/// The report of a reduced system, and its use in place of the full one.
using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A clamped beam with all of its modes, or its first ones: force at the tip, motion there.
Diagram boom(std::optional<int> modes = {}) {
  Beam beam{.length = 2,
            .section = rectangle(0.06, 0.04),
            .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
            .elements = 8};
  beam.modes.kept = modes;
  beam.modes.xi = {0.01};
  Diagram d{"boom"};
  auto F = d.input("F", 3);
  auto b = d.add("b", FlexibleBody(beam));
  b.parent.accel = 0;
  auto tip = b.child("C");
  tip.force.linear = F;
  tip.force.angular = 0;
  d.output("x", 3) = tip.position.linear();
  d.output("a", 3) = tip.accel.linear;
  return d;
}

}  // namespace

TEST_CASE("a reduced system reports its scene, step by step") {
  const titop::Scene scene{.band_hz = {0, 60}, .accuracy = 1e-3, .damping_floor = 0.01};
  const ReducedSystem r = compile(boom(), scene);
  CHECK(r.scene().accuracy == scene.accuracy);
  CHECK(r.scene().band_hz == scene.band_hz);
  const std::string text = to_string(r);
  CHECK(has_line(text, {"1.0e-03", "0", "60 Hz", "s = (0.01 + 0.99995 j) omega"}));
  CHECK(has_line(text, {"whole"}));
  CHECK(r.bound().kind == BoundKind::estimate);
  CHECK(has_line(text, {two_digits(r.bound().worst), fmt::format("{}", r.bound().samples)}));
  const std::vector<double> both{1e-2, 1e-4};
  for (const WhatIf& w : what_if(boom(), scene, both))
    CHECK(w.system.scene().accuracy == w.accuracy);
}

TEST_CASE("a band beyond a body's data is said, with the modes that it would need") {
  // The fourth clamped mode of the beam is a bending mode about its stiff axis: its frequency by
  // hand from cos x cosh x = -1, up to the effect of shear in a slender beam.
  const double x2 = 4.6940911, width = 0.06, rho_A = 2700 * 0.06 * 0.04,
               EI = 70e9 * 0.04 * width * width * width / 12,
               fourth = x2 * x2 / 4 * std::sqrt(EI / rho_A) / (2 * 3.141592653589793);
  const ReducedSystem r = compile(boom(4), titop::Scene{.band_hz = {0, 60}});
  REQUIRE(r.notes().size() == 1);
  const std::string& text = r.notes()[0].text;
  CHECK(has_names(text, {"b", "60 Hz", "90 Hz"}));
  CHECK(std::abs(std::stod(text.substr(text.find_first_of("0123456789"))) / fourth - 1) <= 5e-3);
  CHECK(to_string(r).find(text) != std::string::npos);
  CHECK(compile(boom(), titop::Scene{.band_hz = {0, 60}}).notes().empty());
  CHECK(compile(boom(4), titop::Scene{.band_hz = {0, 0.9 * fourth / 1.5}}).notes().empty());
}

TEST_CASE("a chain without a body that could lose modes is refused by its size alone") {
  Diagram d{"chain"};
  auto U = d.input("U");
  SpringMass::Handle last = d.add("z1", SpringMass{.mass = 1, .stiffness = 9});
  last.parent.accel = 0;
  for (int i = 2; i <= 6; ++i) {
    auto next = d.add(fmt::format("z{}", i), SpringMass{.mass = 1, .stiffness = 9});
    mount(next, last.child);
    last = next;
  }
  last.child.force = U;
  d.output("a") = last.child.accel;
  try {
    compile(d, titop::Scene{.band_hz = {0, 1}, .whole_up_to = 3});
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(says(error, Code::bad_value, {"chain", "6", "Scene::whole_up_to = 3"}));
    CHECK(error.mistakes().front().details.empty());  // no bodies
  }
}

TEST_CASE("at a pole every form throws singular") {
  Diagram d{"free"};
  auto U = d.input("U");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4, .parent_mass = 3});
  z.parent.force = -U;
  d.output("x") = z.parent.position;
  const ReducedSystem r = compile(d, titop::Scene{.band_hz = {0.1, 2}});
  CHECK(says(error_of([&] { r.full().transfer(0); }), Code::singular, {"s = 0"}));
  CHECK(says(error_of([&] { r.transfer(0); }), Code::singular, {"free", "s = 0"}));
  CHECK(says(error_of([&] { r.second_order().transfer(0); }), Code::singular, {"s = 0"}));
  CHECK(says(error_of([&] { r.modal().transfer(0); }), Code::singular, {"s = 0"}));
  CHECK(says(error_of([&] { r.state_space().transfer(0); }), Code::singular, {"s = 0"}));
}

TEST_CASE("in the full system's place: the same response to a push within the band") {
  const ReducedSystem r = compile(boom(), titop::Scene{.band_hz = {0, 60}, .accuracy = 1e-4});
  Diagram d{"boom"};
  auto F = d.input("F", 3);
  const StateSpace m = r.state_space();
  auto small = d.add("small", Lti{.A = m.A, .B = m.B, .C = m.C, .D = m.D});
  small.in = F;
  d.output("all", 6) = small.out;
  const System replaced = compile(d);
  CHECK(replaced.order() == r.order());
  CHECK(r.order() <= r.full().order() / 4);
  // A soft push of a second, smooth to its seventh derivative: nothing of it is above the band.
  const auto push = Excitation::function([](double t) {
    return VectorXd(
        VectorXd::Constant(3, t < 1 ? std::pow(std::sin(3.141592653589793 * t), 8) : 0));
  });
  const Simulation run{.step = 1e-3, .until = 2, .stepper = Stepper::exact};
  const MatrixXd full = simulate(r.full(), push, run).y, y = simulate(replaced, push, run).y;
  // |e(t)| <= max |E| times the integral of |F| over the frequencies, which for this push is its
  // height, 1. The axis is nearer to the poles than the bound's samples by the damping floor of
  // 0.002, at a damping of 0.01: a factor 1.2. Of positions alone: accelerations also see the
  // corners of a push that is linear in every step.
  const VectorXd allowed = 1.2 * r.bound().pairs.cwiseProduct(r.bound().peak).rowwise().sum();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double off = (y - full).row(i).cwiseAbs().maxCoeff();
    CHECK(off <= allowed(i));
    CHECK(off <= 1e-3 * full.row(i).cwiseAbs().maxCoeff());
  }
}
