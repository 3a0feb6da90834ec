#pragma once

#include <complex>
#include <span>
#include <vector>

/// Samples of a rational function that bound it everywhere between them.
namespace titop::detail {

/// A band, and the poles of the function that is sampled there.
struct PhaseBand {
  double low = 0, high = 1;                 ///< of the real variable
  std::vector<std::complex<double>> poles;  ///< in that variable, off the interval
  int far = 0;                              ///< more poles, counted as at infinity
};

/// Points of [low, high] between which the phase that these poles can turn grows by at most `step`,
/// both ends included. For a function with no other poles, whose numerator has no higher degree
/// than its denominator, |f| <= max over the points / cos(step / 2) everywhere in the band: the
/// Bernstein-Szego inequality for rational functions [Borwein, Erdelyi 1995, Polynomials and
/// Polynomial Inequalities, ch. 7], for Re(e^(ja) f). Poles on the interval are moved off it by a
/// small distance. O(points * poles).
std::vector<double> phase_grid(const PhaseBand& band, double step);

}  // namespace titop::detail
