#include <cmath>
#include <numbers>
#include <titop/analysis/reduction/phase_grid.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

constexpr double kOff = 1e-12;      ///< of half the band: a pole on it moves off it
constexpr double kSettled = 1e-14;  ///< of a half turn: a point has its digits

/// z with |z| < 1 and x = (z + 1/z) / 2: where the outside of [-1, 1] is the inside of a circle.
Complex inside(Complex x) {
  if (x.imag() == 0 && std::abs(x.real()) <= 1) x += Complex(0, kOff);
  const Complex r = std::sqrt(x - 1.0) * std::sqrt(x + 1.0);
  const Complex z = x - r, other = x + r;
  // The smaller root, from the larger one: no cancellation.
  return std::abs(z) < std::abs(other) ? 1.0 / other : 1.0 / z;
}

/// Phase of all poles from t = 0 to t, x = cos t: each turns 2 pi from 0 to pi.
struct Phase {
  std::vector<Complex> z;
  int far = 0;

  double at(double t) const {
    const Complex e = std::polar(1.0, t);
    double sum = 2 * t * (static_cast<double>(z.size()) + far);
    for (const Complex& c : z)
      sum += 2 * (std::arg(1.0 - c * std::conj(e)) - std::arg(1.0 - c * e));
    return sum;
  }
  double slope(double t) const {
    const Complex e = std::polar(1.0, t);
    double sum = 2.0 * far;
    for (const Complex& c : z)
      sum += 2 * ((1.0 - c * c) / ((1.0 - c * e) * (1.0 - c * std::conj(e)))).real();
    return sum;
  }
  /// t in [low, high] where the phase is `target`: Newton's steps, bisection where they leave the
  /// bracket or do not halve the step before last.
  double find(double target, double low, double high) const {
    double t = (low + high) / 2, step = high - low, before = step;
    for (int i = 0; i < 200; ++i) {
      const double off = at(t) - target;
      (off < 0 ? low : high) = t;
      const double newton = -off / slope(t);
      const bool good =
          t + newton > low && t + newton < high && std::abs(newton) <= std::abs(before) / 2;
      before = step;
      step = good ? newton : (low + high) / 2 - t;
      t += step;
      if (std::abs(step) <= kSettled * pi) break;
    }
    return t;
  }
};

}  // namespace

std::vector<double> phase_grid(const PhaseBand& band, double step) {
  const double half = (band.high - band.low) / 2, middle = (band.high + band.low) / 2;
  Phase phase{{}, band.far};
  for (const Complex& p : band.poles) phase.z.push_back(inside((p - middle) / half));
  const double total = phase.at(pi);
  const int count = std::max(2, static_cast<int>(std::ceil(total / step * linalg::kTie)));
  std::vector<double> points(static_cast<std::size_t>(count) + 1);
  double t = 0;
  for (int i = 0; i <= count; ++i) {
    if (i == count)
      t = pi;
    else if (i > 0)
      t = phase.find(total * i / count, t, pi);
    const double c = std::cos(t / 2);  // middle + half cos t would cancel near the lower end
    points[static_cast<std::size_t>(count - i)] = band.low + (band.high - band.low) * c * c;
  }
  points.front() = band.low;
  points.back() = band.high;
  return points;
}

}  // namespace titop::detail
