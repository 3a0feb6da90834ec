#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

/// Scenes of the tests of economy, and what is measured on them.
namespace titop_test {

using titop::Diagram;
using titop::ReducedSystem;

/// An aluminium beam of 2 m with 6 * elements modes.
inline titop::FlexibleBody slim_beam(int elements = 8, double xi = 0) {
  titop::Beam beam{.length = 2,
                   .section = titop::rectangle(0.06, 0.04),
                   .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                   .elements = elements};
  if (xi > 0) beam.modes.xi = {xi};
  return beam;
}

/// Three beams in a skew chain, clamped; wrench at the tip to acceleration there.
inline Diagram frame(const titop::FlexibleBody& beam) {
  Diagram d{"frame"};
  auto U = d.input("U", 6);
  auto b1 = d.add("b1", beam), b2 = d.add("b2", beam), b3 = d.add("b3", beam);
  b1.parent.accel = 0;
  mount(b2, b1.child("C"), titop::Rotation::about({1, 2, 3}, 0.7));
  mount(b3, b2.child("C"), titop::Rotation::about({3, -1, 1}, -1.1));
  b3.child("C").force = U;
  d.output("a", 6) = b3.child("C").accel;
  return d;
}

/// The largest error of any pair over what its bound allows, on a grid of the band that knows
/// nothing of the bound's: equal steps, and 41 points across every pole of the full system.
struct Against {
  double bound = 0;  ///< largest |error| / (bound of the pair * its peak): 1 or less
  double error = 0;  ///< largest |error| / peak
};
inline Against on_fine_grid(const ReducedSystem& r, const titop::Scene& scene, int steps = 1500) {
  const double low = 2 * std::numbers::pi * scene.band_hz[0];
  const double high = 2 * std::numbers::pi * scene.band_hz[1], zeta = scene.damping_floor;
  std::vector<double> omega;
  for (int i = 1; i <= steps; ++i) omega.push_back(low + (high - low) * i / steps);
  for (int i = 1; i <= 30; ++i)  // from the lower end on by factors, from 0 on over nine decades
    omega.push_back(low > 0 ? low * std::pow(high / low, i / 31.0) : high * std::pow(10, -0.3 * i));
  for (const titop::Pole& p : r.full().poles())
    for (int i = -20; i <= 20; ++i)
      if (const double w = p.omega * (1 + 0.2 * zeta * i); w > low && w < high) omega.push_back(w);
  Against worst;
  for (const double w : omega) {
    const std::complex<double> s{zeta * w, std::sqrt(1 - zeta * zeta) * w};
    const Eigen::MatrixXd error = (r.full().transfer(s) - r.transfer(s)).cwiseAbs();
    const titop::ErrorBound& b = r.bound();
    const Eigen::MatrixXd relative = error.cwiseQuotient(b.peak);
    worst.error = std::max(worst.error, relative.maxCoeff());
    worst.bound = std::max(worst.bound, relative.cwiseQuotient(b.pairs).maxCoeff());
  }
  return worst;
}

}  // namespace titop_test
