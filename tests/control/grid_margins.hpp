#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <titop/analysis/control/margins.hpp>

#include "support/rng.hpp"

/// Random loops in factors, and their margins by bisection on a fine grid, in long double.
namespace titop_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Real = long double;
using Complex = std::complex<Real>;
using Function = std::function<Complex(Real)>;  ///< of omega

inline constexpr Real kPi = std::numbers::pi_v<Real>;

/// A term of a sum: (b1 s + b0) / (s^2 + a1 s + a0), or b0 / (s + a0).
struct Fraction {
  bool second;
  double a1, a0, b1, b0;
  Complex at(Real w) const {
    const Complex s{0, w};
    return second ? (Real(b1) * s + Real(b0)) / (s * s + Real(a1) * s + Real(a0))
                  : Real(b0) / (s + Real(a0));
  }
};

inline titop::StateSpace model_of(const std::vector<Fraction>& parts) {
  Index n = 0;
  for (const Fraction& p : parts) n += p.second ? 2 : 1;
  titop::StateSpace m;
  m.A = MatrixXd::Zero(n, n), m.B = MatrixXd::Zero(n, 1), m.C = MatrixXd::Zero(1, n);
  m.D = MatrixXd::Zero(1, 1);
  Index i = 0;
  for (const Fraction& p : parts) {
    if (p.second) {
      m.A.block(i, i, 2, 2) << 0, 1, -p.a0, -p.a1;
      m.B(i + 1, 0) = 1;
      m.C(0, i) = p.b0, m.C(0, i + 1) = p.b1;
    } else {
      m.A(i, i) = -p.a0, m.B(i, 0) = 1, m.C(0, i) = p.b0;
    }
    i += p.second ? 2 : 1;
  }
  return m;
}

inline std::vector<Fraction> random_parts(Rng& rng, bool unstable, bool integral, double size,
                                          int most = 4) {
  std::vector<Fraction> parts;
  const int modes = 1 + rng.below(most);
  for (int k = 0; k < modes; ++k) {
    const double w = std::pow(10, rng.between(-1, 1.5)), xi = std::pow(10, rng.between(-6, -0.3));
    const double part = rng.between(0.05, 1), sign = rng.chance(0.3) ? -0.02 : 1;
    const double share = size * part * sign;
    parts.push_back({true, 2 * xi * w, w * w, share * rng.between(0.2, 2), share * w * 0.3});
  }
  const int lags = 1 + rng.below(2);
  for (int k = 0; k < lags; ++k)
    parts.push_back({false, 0, std::pow(10, rng.between(-2, 1)), 0, size * rng.between(0.1, 3)});
  if (unstable) {
    const double a = rng.between(0.05, 0.6);
    parts.push_back({false, 0, -a, 0, a * rng.between(1.5, 9)});
  } else if (integral) {
    parts.push_back({false, 0, 0, 0, size * rng.between(0.1, 2)});
  }
  return parts;
}

/// A grid that resolves every pole: its half width times 1e-2 to 1e6, and logarithmic.
inline std::vector<Real> grid(const std::vector<Fraction>& parts) {
  std::vector<Real> list{1e-12L};  // and 0, nearly
  for (int k = 0; k <= 900; ++k) list.push_back(std::pow(Real(10), -5 + Real(k) / 100));
  for (const Fraction& p : parts) {
    if (!p.second) continue;
    const Real half = Real(p.a1) / 2, w = std::sqrt(Real(p.a0) - half * half);
    for (int k = -80; k <= 240; ++k)
      for (const int sign : {-1, 1})
        if (const Real x = w + sign * half * std::pow(Real(10), Real(k) / 40); x > 0)
          list.push_back(x);
  }
  std::sort(list.begin(), list.end());
  return list;
}

/// Changes of sign of f, by bisection.
inline std::vector<Real> roots(const std::function<Real(Real)>& f, const std::vector<Real>& list) {
  std::vector<Real> result;
  Real last = f(list[0]);
  for (std::size_t i = 1; i < list.size(); ++i) {
    const Real now = f(list[i]);
    if (now * last < 0) {
      Real a = list[i - 1], b = list[i];
      for (int k = 0; k < 70; ++k) {
        const Real m = (a + b) / 2;
        (f(m) * last > 0 ? a : b) = m;
      }
      result.push_back(a);
    }
    last = now;
  }
  return result;
}

/// The least f, by thirds around every local minimum of the grid.
inline Real least(const std::function<Real(Real)>& f, const std::vector<Real>& list) {
  std::vector<Real> value;
  for (const Real w : list) value.push_back(f(w));
  Real best = *std::min_element(value.begin(), value.end());
  for (std::size_t i = 1; i + 1 < list.size(); ++i) {
    if (value[i] > value[i - 1] || value[i] > value[i + 1]) continue;
    Real a = list[i - 1], b = list[i + 1];
    for (int k = 0; k < 50; ++k) {
      const Real x = a + (b - a) / 3, y = b - (b - a) / 3;
      (f(x) < f(y) ? b : a) = f(x) < f(y) ? y : x;
    }
    best = std::min(best, f(a));
  }
  return best;
}

struct Expected {
  Real larger = HUGE_VALL, smaller = 0, phase = HUGE_VALL, delay = HUGE_VALL, nearest, disk;
};

inline Expected expected(const Function& L, const std::vector<Real>& list, Complex at_zero) {
  Expected e;
  const auto gain = [&](Complex l) {
    if (l.real() >= 0) return;
    const Real factor = 1 / std::abs(l);
    if (factor > 1) e.larger = std::min(e.larger, factor);
    if (factor < 1) e.smaller = std::max(e.smaller, factor);
  };
  for (const Real w : roots([&](Real x) { return L(x).imag() / std::abs(L(x)); }, list)) gain(L(w));
  if (std::abs(at_zero) < 1e15L) gain(at_zero);
  for (const Real w : roots([&](Real x) { return std::log(std::abs(L(x))); }, list)) {
    const Real ahead = std::arg(-L(w));
    e.phase = std::min(e.phase, std::abs(ahead));
    e.delay = std::min(e.delay, (ahead < 0 ? ahead + 2 * kPi : ahead) / w);
  }
  e.nearest = least([&](Real w) { return std::abs(1.0L + L(w)); }, list);
  e.nearest = std::min(e.nearest, 1.0L);  // at infinity
  e.disk = least([&](Real w) { return 2 * std::abs(1.0L + L(w)) / std::abs(1.0L - L(w)); }, list);
  e.disk = std::min(e.disk, 2.0L);
  return e;
}

inline double off(double value, Real exact) {
  if (std::isinf(exact) || exact == 0) return value == static_cast<double>(exact) ? 0 : 1;
  return static_cast<double>(std::abs(value / exact - 1));
}

inline double worst(const titop::LoopMargins& m, const Expected& e) {
  return std::max({off(m.larger_gain.value, e.larger), off(m.smaller_gain.value, e.smaller),
                   off(m.phase.value, e.phase), off(m.delay.value, e.delay),
                   off(m.nearest.value, e.nearest), off(m.disk.alpha, e.disk)});
}

/// Right half plane poles of the closed loop, by Eigen alone.
inline int unstable(const titop::StateSpace& L) {
  const MatrixXd A = L.A - L.B * L.C;  // D = 0
  int count = 0;
  const Eigen::VectorXcd poles = Eigen::EigenSolver<MatrixXd>(A, false).eigenvalues();
  for (const std::complex<double>& s : poles) count += s.real() > 0;
  return count;
}

}  // namespace titop_test
