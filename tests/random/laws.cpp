#include <doctest/doctest.h>

#include <cmath>
#include <titop/compiler/minreal/poles.hpp>

#include "support/random_checks.hpp"

/// Laws of every diagram, on the same random ones: the order of writing and the units do not
/// matter; undamped poles lie on the axis, damped ones left of it.

using namespace titop_test;
using titop::compile;

TEST_CASE("random graphs: shuffled adds and equations give the same model to the last bit") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Scene scene = random_scene(random_options(seed));
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
    CHECK_NOTHROW(error = units_error(random_scene(random_options(seed)), units));
    CHECK(error <= 1e-9);
  }
}

TEST_CASE("random graphs: powers of ten from 1e-12 to 1e12 in one unit change numbers alone") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Scene scene = random_scene(random_options(seed));
    for (const double factor : {1e-12, 1e-6, 1e6, 1e12})
      for (const Units& units :
           {Units{.length = factor}, Units{.mass = factor}, Units{.time = factor}}) {
        CAPTURE(seed);
        CAPTURE(factor);
        double error = 1;
        CHECK_NOTHROW(error = units_error(scene, units));
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
  SceneOptions options = random_options(seed);
  options.damping = damping;
  options.controllers = false;
  const Scene scene = random_scene(options);
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
