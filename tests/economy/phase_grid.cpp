#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/economy/phase_grid.hpp>

#include "support/rng.hpp"

using titop::detail::phase_grid;
using titop::detail::PhaseBand;
using Complex = std::complex<double>;

namespace {

/// A random rational function of degree (n, n): poles near the interval, in clusters and far away.
struct Rational {
  std::vector<Complex> poles, residues;
  Complex direct;
  Complex at(double x) const {
    Complex sum = direct;
    for (std::size_t k = 0; k < poles.size(); ++k) sum += residues[k] / (x - poles[k]);
    return sum;
  }
};

Rational random_rational(titop_test::Rng& rng, double low, double high) {
  Rational f;
  const int count = 3 + rng.below(12);
  for (int k = 0; k < count; ++k) {
    const bool close = !f.poles.empty() && rng.chance(0.3);
    const double x = close ? f.poles.back().real() * (1 + 1e-4 * rng.unit())
                           : rng.between(low - (high - low), high + (high - low));
    const double y = (rng.chance(0.5) ? 1 : -1) * (high - low) * std::pow(10, -4 * rng.unit());
    f.poles.emplace_back(x, y);
    // Of the size that a lightly damped mode has there.
    f.residues.emplace_back(Complex(rng.between(-1, 1), rng.between(-1, 1)) * y);
  }
  f.direct = {rng.between(-0.1, 0.1), rng.between(-0.1, 0.1)};
  return f;
}

}  // namespace

TEST_CASE("no peak of a rational function hides between the samples of its phase grid") {
  titop_test::Rng rng(6);
  for (int scene = 0; scene < 60; ++scene) {
    const double low = rng.between(0, 3), high = low + rng.between(0.1, 50), step = 1;
    const Rational f = random_rational(rng, low, high);
    const std::vector<double> grid = phase_grid({low, high, f.poles, 0}, step);
    CHECK(grid.front() == low);
    CHECK(grid.back() == high);
    CHECK(std::is_sorted(grid.begin(), grid.end()));
    // Each pole turns the phase by 2 pi over the band.
    CHECK(grid.size() <= 2 + static_cast<std::size_t>(6.3 * static_cast<double>(f.poles.size())));
    double sampled = 0, largest = 0;
    for (const double x : grid) sampled = std::max(sampled, std::abs(f.at(x)));
    for (std::size_t k = 1; k < grid.size(); ++k)
      for (int i = 0; i < 50; ++i)
        largest = std::max(largest, std::abs(f.at(grid[k - 1] + (grid[k] - grid[k - 1]) * i / 50)));
    CHECK(largest <= sampled / std::cos(step / 2) * (1 + 1e-6));
  }
}

TEST_CASE("a uniform grid of as many points misses the peak of a lightly damped mode") {
  // The case that the phase grid is for: 1 / (x - p) with p 1e-4 of the band beside it.
  const Complex pole(0.4321, 1e-4);
  const std::vector<double> grid = phase_grid({0, 1, {pole}, 0}, 1);
  double phase = 0, uniform = 0;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    phase = std::max(phase, 1 / std::abs(grid[k] - pole));
    uniform = std::max(
        uniform,
        1 / std::abs(static_cast<double>(k) / static_cast<double>(grid.size() - 1) - pole));
  }
  CHECK(phase * 1.14 >= 1e4);
  CHECK(uniform * 20 <= 1e4);
}
