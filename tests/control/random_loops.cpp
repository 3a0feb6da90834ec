#include <doctest/doctest.h>

#include "control/grid_margins.hpp"

/// Margins of random single loops against a fine grid of their factors: poles near the axis
/// (damping ratios down to 1e-6), unstable plants, delays.

using namespace titop;
using namespace titop_test;

TEST_CASE("170 random single loops") {
  Rng rng(71);
  int done = 0, open_unstable = 0, refused = 0;
  double largest = 0;
  while (done < 170) {
    const bool unstable_plant = rng.chance(0.4);
    const double size = std::pow(10, rng.between(-2, 0.5));
    const auto parts = random_parts(rng, unstable_plant, rng.chance(0.4), size);
    const StateSpace L = model_of(parts);
    const Margins m = margins(L);
    CHECK(m.nyquist.agree);
    CHECK(m.nyquist.closed_right == unstable(L));
    CHECK(m.stable == (unstable(L) == 0));
    if (!m.stable) {
      ++refused;
      continue;
    }
    ++done, open_unstable += m.nyquist.open_right > 0;
    const auto at = [&](Real w) {
      Complex sum = 0;
      for (const Fraction& p : parts) sum += p.at(w);
      return sum;
    };
    const double error = worst(m.loops[0], expected(at, grid(parts), at(0)));
    if (error > 1e-6) MESSAGE(done, ": ", error, "\n", to_string(m));
    largest = std::max(largest, error);
  }
  MESSAGE("largest difference ", largest, ", unstable plants ", open_unstable, ", refused ",
          refused);
  CHECK(largest <= 1e-6);
  CHECK(open_unstable >= 20);
  CHECK(refused >= 10);
}

TEST_CASE("120 random single loops with half of their delay margin as a delay") {
  Rng rng(72);
  int done = 0;
  double largest = 0;
  while (done < 120) {
    const bool unstable_plant = rng.chance(0.3);
    const double size = std::pow(10, rng.between(-1, 1));
    const auto parts = random_parts(rng, unstable_plant, false, size);
    const StateSpace L = model_of(parts);
    const auto list = grid(parts);
    const auto without = [&](Real w) {
      Complex sum = 0;
      for (const Fraction& p : parts) sum += p.at(w);
      return sum;
    };
    if (unstable(L) > 0) continue;
    const Expected now = expected(without, list, without(0));
    // The grid's points are 2.3 % apart: beyond 30 rad/s L has no mode, and the delay turns it
    // fast.
    const Real delay = now.delay / 2;
    if (!(delay * 30 <= 20)) continue;
    const Margins m = margins(L, {.delay = static_cast<double>(delay)});
    const Expected left = expected(
        [&](Real w) { return without(w) * std::exp(Complex(0, -w * delay)); }, list, without(0));
    CHECK(m.stable);  // delays below the least that brings L to -1
    CHECK(off(m.loops[0].delay.value, now.delay - delay) <= 1e-6);
    const double error = worst(m.loops[0], left);
    if (error > 1e-6) MESSAGE(done, ": ", error, "\n", to_string(m));
    largest = std::max(largest, error);
    ++done;
  }
  CHECK(largest <= 1e-6);
}
