#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <titop/compiler/minreal/poles.hpp>

#include "support/random_checks.hpp"

/// Laws of every diagram, on the same random ones: the order of writing and the units do not
/// matter; undamped poles lie on the axis, damped ones left of it.

using namespace titop::generate;
using namespace titop_test;
using titop::compile;

TEST_CASE("random graphs: shuffled adds and equations give the same model to the last bit") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const RandomDiagram scene = random_diagram(random_options(seed));
    for (const titop::Options& options : {titop::Options{.minimize_up_to = 0}, titop::Options{}}) {
      const titop::StateSpace model = compile(scene.build(), options).state_space();
      for (const std::uint64_t order : {seed, seed + 1000}) {
        CAPTURE(seed);
        CAPTURE(order);
        CHECK(difference_by_name(model, compile(scene.shuffled(order), options).state_space()) ==
              "");
      }
    }
  }
}

TEST_CASE("random graphs: units leave verdict and transfer unchanged") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Rng rng(seed);
    Units units;
    units.length = std::pow(10.0, rng.below(7) - 3);
    units.mass = std::pow(10.0, rng.below(7) - 3);
    units.time = std::pow(10.0, rng.below(7) - 3);
    CAPTURE(seed);
    double error = 1;
    CHECK_NOTHROW(error = units_error(random_diagram(random_options(seed)), units));
    CHECK(error <= 1e-9);
  }
}

namespace {

/// Its order and the passes that warn, but for `check`: it knows the sizes of materials in SI.
std::string verdict_on(const titop::Diagram& d) {
  const titop::System system = compile(d, {.minimize_up_to = 0});
  std::string text = std::to_string(system.order());
  for (const titop::Note& note : system.notes())
    if (note.kind == titop::Note::Kind::warning && note.pass != "check") text += " " + note.pass;
  return text;
}

}  // namespace

TEST_CASE(
    "random graphs: powers of ten from 1e-12 to 1e12 in one unit, or 1e-9 and 1e9 in all, "
    "change numbers alone") {
  std::vector<std::uint64_t> seeds(40);
  std::iota(seeds.begin(), seeds.end(), 1u);
  seeds.push_back(565);  // rounding of an output's 0 by one input, beside its value by another
  for (const std::uint64_t seed : seeds) {
    const RandomDiagram scene = random_diagram(random_options(seed));
    const std::string verdict = verdict_on(scene.build());
    std::vector<Units> all{{.length = 1e-9, .mass = 1e-9, .time = 1e-9},
                           {.length = 1e9, .mass = 1e9, .time = 1e9}};
    for (const double factor : {1e-12, 1e-6, 1e6, 1e12})
      all.insert(all.end(), {{.length = factor}, {.mass = factor}, {.time = factor}});
    for (const Units& units : all) {
      CAPTURE(seed);
      CAPTURE(units.length);
      CAPTURE(units.mass);
      CAPTURE(units.time);
      double error = 1;
      CHECK_NOTHROW(error = units_error(scene, units));
      CHECK(error <= 1e-9);
      CHECK(verdict_on(scene.build(units)) == verdict);
    }
  }
}

namespace {

/// Units of length, mass and time in which the same numbers are written.
struct InUnits {
  double length = 1, mass = 1, time = 1;
  double force() const { return mass * length / (time * time); }

  /// A steel rod of one element on a wall, a rigid tip on a ball joint, a force across it.
  titop::Diagram rod() const {
    using namespace titop;
    const double pressure = force() / (length * length);
    Diagram d{"rod"};
    auto u = d.input("u");
    auto rod =
        d.add("rod", FlexibleBody(Beam{.length = 2 * length,
                                       .section = rectangle(0.06 * length, 0.04 * length),
                                       .material = {.E = 210e9 * pressure,
                                                    .nu = 0.3,
                                                    .rho = 7850 * mass / std::pow(length, 3)},
                                       .elements = 1}));
    const double inertia = mass * length * length;
    auto tip = d.add("tip", RigidBody{.mass = 3 * mass,
                                      .inertia = {0.2 * inertia, 0.3 * inertia, 0.25 * inertia},
                                      .PA = {0.1 * length, 0, 0},
                                      .children = {{"C", {0.4 * length, 0, 0}}}});
    ground(rod);
    joint(d, "ball", tip, rod.child, Rotation(), ball());
    tip.child.force.linear.along({0, 1, 0}) += u;
    d.output("a", 6) = tip.child.accel;
    return d;
  }
  /// A hub in free space with two rods of rigid bodies: no chain is closed.
  titop::Diagram tree() const {
    using namespace titop;
    const double inertia = mass * length * length;
    const auto link = [&](double m) {
      return RigidBody{.mass = m * mass,
                       .inertia = {0.2 * inertia, 0.3 * inertia, 0.25 * inertia},
                       .PA = {0.1 * length, 0.2 * length, 0},
                       .children = {{"A", {0.4 * length, 0, 0}}, {"B", {0, 0.5 * length, 0}}}};
    };
    Diagram d{"tree"};
    auto hub = d.add("hub", link(20)), left = d.add("left", link(2)),
         right = d.add("right", link(3));
    hub.parent.force = -d.input("U", 6);
    hinge(d, "h1", left, hub.child("A"), Rotation(), {0, 0, 1}).torque = 0;
    hinge(d, "h2", right, hub.child("B"), Rotation(), {1, 0, 0}).torque = 0;
    d.output("a", 6) = hub.parent.accel;
    return d;
  }
};

/// The largest error of the transfer, per unit of translations and of rotations.
double error_in(const InUnits& units, titop::Diagram (InUnits::*scene)() const) {
  const titop::System ours = compile((InUnits{}.*scene)()), theirs = compile((units.*scene)());
  CHECK(theirs.log().find("singular posture") == std::string::npos);
  double worst = 0;
  for (const std::complex<double> s : {std::complex<double>(3, 40), {0.2, 1}, {100, 5000}}) {
    Eigen::MatrixXcd G = theirs.transfer(s / units.time);
    const Eigen::MatrixXcd exact = ours.transfer(s);
    const double t2 = units.time * units.time;
    G.topRows(3) *= t2 / units.length, G.bottomRows(3) *= t2;
    G.leftCols(std::min<Eigen::Index>(3, G.cols())) *= units.force();
    if (G.cols() == 6) G.rightCols(3) *= units.force() * units.length;
    worst = std::max(worst, (G - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace

TEST_CASE(
    "units: a rod of one element and a tree, in units of 1e-12 to 1e12 and all three at once") {
  std::vector<InUnits> all;
  for (const double factor : {1e-12, 1e-9, 1e9, 1e12}) {
    all.insert(all.end(), {{.length = factor}, {.mass = factor}, {.time = factor}});
    if (factor == 1e-9 || factor == 1e9) all.push_back({factor, factor, factor});
  }
  for (const InUnits& units : all) {
    CAPTURE(units.length);
    CAPTURE(units.mass);
    CAPTURE(units.time);
    for (const auto scene : {&InUnits::rod, &InUnits::tree}) {
      double error = 1;
      CHECK_NOTHROW(error = error_in(units, scene));
      CHECK(error <= 1e-9);
    }
  }
}

namespace {

/// Poles of scenes without controllers; `zeros` are those below 1e-5 of the largest.
struct Poles {
  double largest_real = -1;  ///< Re / |s| of the others
  double largest_axis = 0;   ///< |Re| / |s| of the others
  int zeros = 0, loose = 0;
};

Poles poles_of(std::uint64_t seed, Damping damping) {
  RandomOptions options = random_options(seed);
  options.damping = damping;
  options.controllers = false;
  const RandomDiagram scene = random_diagram(options);
  const auto list = compile(scene.build()).poles();
  Poles result;
  result.loose = scene.loose;
  const double size = list.empty() ? 0 : list.back().omega;
  for (const titop::Pole& p : list) {
    if (p.omega <= 1e-5 * size || p.omega == 0) {
      result.zeros += p.pair ? 2 : 1;
      continue;
    }
    result.largest_real = std::max(result.largest_real, p.s.real() / p.omega);
    result.largest_axis = std::max(result.largest_axis, std::abs(p.s.real()) / p.omega);
  }
  return result;
}

}  // namespace

TEST_CASE("random graphs: undamped poles lie on the axis") {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    const Poles poles = poles_of(seed, Damping::none);
    CHECK(poles.largest_axis <= 1e-9);
    CHECK(poles.zeros <= 2 * poles.loose);
  }
}

TEST_CASE("random graphs: damped poles lie left of the axis") {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    const Poles poles = poles_of(seed, Damping::all);
    CHECK(poles.largest_real <= 0);
    CHECK(poles.zeros <= 2 * poles.loose);
  }
}
