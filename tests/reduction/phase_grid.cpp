#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <titop/analysis/reduction/phase_grid.hpp>

#include "against.hpp"
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
    const double sign = rng.sign(), y = sign * (high - low) * std::pow(10, -4 * rng.unit());
    f.poles.emplace_back(x, y);
    // Residues of the size of a lightly damped mode there.
    const double im = rng.between(-1, 1);
    f.residues.push_back(Complex(rng.between(-1, 1), im) * y);
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
  // The case that the phase grid is for: 1 / (x - p) with p at 1e-4 of the band from it.
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

TEST_CASE("the reference grid of scenes is ten times finer than the bound's, everywhere") {
  // Modes in the band, in clusters and just above its end; and of the reduced model vectors above
  // the band, on which the finer grid does not depend.
  titop_test::Rng rng(8);
  for (int scene = 0; scene < 40; ++scene) {
    CAPTURE(scene);
    const double high = rng.between(1, 100), low = rng.chance(0.5) ? 0 : rng.between(0, high / 2);
    const double zeta = std::pow(10, -rng.between(1.5, 3.5));
    std::vector<double> whole, small;
    double next = 2 * high;
    for (int k = rng.below(40); k >= 0; --k) {
      const bool close = !whole.empty() && rng.chance(0.3);
      whole.push_back(close ? whole.back() * (1 + zeta * rng.between(-1, 1))
                            : high * rng.between(0.01, 2));
      if (whole.back() > high) next = std::min(next, whole.back());
    }
    for (int k = rng.below(7); k > 0; --k) small.push_back(rng.between(next, 2.1 * high));
    const auto grid = [&](const std::vector<double>& more) {
      const Complex turned{0, -1}, ray{zeta, std::sqrt(1 - zeta * zeta)};
      PhaseBand band{low * low, high * high, {}, 10};
      for (const auto& list : {whole, more})
        for (const double w : list)
          if (w <= 2 * high) band.poles.push_back(std::pow(w * turned / ray, 2));
      std::vector<double> points = phase_grid(band, 1);
      for (double& p : points) p = std::sqrt(p);
      return points;
    };
    const std::vector<double> check = grid(small);
    const auto samples = static_cast<int>(check.size() + grid({}).size());
    const double hertz = 1 / (2 * std::numbers::pi);
    const titop::Scene question{.band_hz = {low * hertz, high * hertz}, .damping_floor = zeta};
    const std::vector<double> fine = titop_test::fine_points(question, whole, 18 * samples);
    CHECK(std::is_sorted(fine.begin(), fine.end()));
    std::size_t fewest = fine.size(), first = 0;
    for (std::size_t k = 1; k < check.size(); ++k) {
      std::size_t last = first;
      while (last < fine.size() && fine[last] <= check[k] * (1 + 1e-12)) ++last;
      fewest = std::min(fewest, last - first);
      first = last;
    }
    CHECK(fewest >= 10);
  }
}
