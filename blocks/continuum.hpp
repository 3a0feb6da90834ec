#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <type_traits>
#include <utility>

/// Closed forms of a uniform rod, shaft and Euler-Bernoulli beam, clamped at x = 0 and free at
/// x = L, as functions of a dimensionless q: 0 at rest, positive on the undamped s = j omega. For
/// the folder's own files. Z is a complex number of any precision.
namespace titop::detail {

template <class Z>
using RealOf = std::decay_t<decltype(std::declval<const Z&>().real())>;

/// A function f of q with f(0) = `at_zero`. Up to |q| = 1 its slope is given, too, (f - f(0)) / q,
/// whose digits do not cancel there; beyond it the value may be far smaller than f(0).
template <class Z>
struct FromRest {
  RealOf<Z> at_zero;
  Z value, slope = Z(0);
};
template <class Z, std::size_t N>
using AllFromRest = std::array<FromRest<Z>, N>;

/// Rod and shaft: gamma^2 = q.
template <class Z>
struct Axial {
  FromRest<Z> end;     ///< tan(gamma) / gamma: compliance of the end, mass at the root
  FromRest<Z> across;  ///< 1 / cos(gamma): motion of the end by the root
};

/// Bending: z^4 = q, D = 1 + cos z cosh z [Bishop and Johnson 1960, *The Mechanics of Vibration*,
/// 7].
template <class Z>
struct Bending {
  FromRest<Z> deflection;  ///< (sin cosh - cos sinh) / (z^3 D): by a force; inertia at the root
  FromRest<Z> mixed;       ///< sin sinh / (z^2 D): by a moment; first moment
  FromRest<Z> rotation;    ///< (cos sinh + sin cosh) / (z D): slope by a moment; mass
  FromRest<Z> across;      ///< (cos + cosh) / D: of the end by the root, slope by slope as well
  FromRest<Z> lever;       ///< (sin + sinh) / (z D): deflection by the root's slope
  FromRest<Z> bow;         ///< (sinh - sin) / (z^3 D): slope by the root's deflection, over q
};

/// Up to |q| = 1 the power series are used; beyond it the closed forms lose less than one digit.
template <class Z>
bool is_near_rest(const Z& q) {
  return q.real() * q.real() + q.imag() * q.imag() <= 1;
}

// --- near rest: quotients of power series --------------------------------------------------------

/// Coefficients of one power of q, of the numerators and of their common denominator.
template <class R, std::size_t N>
struct Coefficients {
  std::array<R, N> numerator;
  R denominator;
};

/// `of(n)` are the coefficients of q^n; the denominator's decrease faster than 1 / n!.
template <class Z, std::size_t N, class Of>
AllFromRest<Z, N> near_rest(const Z& q, Of of) {
  using R = RealOf<Z>;
  using std::abs;
  const Coefficients<R, N> first = of(0);
  AllFromRest<Z, N> result;
  for (std::size_t i = 0; i < N; ++i)
    result[i] = {first.numerator[i] / first.denominator, Z(0), Z(0)};
  Z denominator = Z(first.denominator), power = Z(1);
  R last;
  int n = 1;
  do {
    const Coefficients<R, N> c = of(n++);
    for (std::size_t i = 0; i < N; ++i)
      result[i].slope += Z(c.numerator[i] - result[i].at_zero * c.denominator) * power;
    power *= q;
    denominator += Z(c.denominator) * power;
    last = abs(c.denominator);
  } while (last > std::numeric_limits<R>::epsilon() / 16);
  for (FromRest<Z>& f : result) {
    f.slope /= denominator;
    f.value = Z(f.at_zero) + q * f.slope;
  }
  return result;
}

template <class Z>
AllFromRest<Z, 2> axial_near_rest(const Z& q) {
  using R = RealOf<Z>;
  R term = 1;  // (-1)^n / (2n)!
  return near_rest<Z, 2>(q, [&](int n) -> Coefficients<R, 2> {
    if (n > 0) term /= -R(2 * n - 1) * R(2 * n);
    return {{R(term / R(2 * n + 1)), n == 0 ? R(1) : R(0)}, term};
  });
}

template <class Z>
AllFromRest<Z, 6> bending_near_rest(const Z& q) {
  using R = RealOf<Z>;
  R term = 1, sign = 1;  // 1 / (4n)!, (-4)^n
  return near_rest<Z, 6>(q, [&](int n) -> Coefficients<R, 6> {
    if (n > 0) {
      term /= R(4 * n - 3) * R(4 * n - 2) * R(4 * n - 1) * R(4 * n);
      sign *= -4;
    }
    const R one = term / R(4 * n + 1), two = one / R(4 * n + 2), three = two / R(4 * n + 3);
    return {{R(4 * sign * three), R(2 * sign * two), R(2 * sign * one), R(2 * term), R(2 * one),
             R(2 * three)},
            n == 0 ? R(2) : R(sign * term)};
  });
}

// --- far from rest: circular and hyperbolic functions without their growth -----------------------

/// cosh(b) and sinh(b) times decay = exp(-b), b >= 0.
template <class R>
struct Hyperbolic {
  R cosine, sine, decay;
  explicit Hyperbolic(const R& b) {
    using std::exp;
    decay = exp(R(-b));
    const R twice = decay * decay;
    cosine = (1 + twice) / 2;
    if constexpr (std::is_floating_point_v<R>)
      sine = -std::expm1(-2 * b) / 2;
    else
      sine = (1 - twice) / 2;
  }
};

/// Circular and hyperbolic functions of z = a + j b, a >= 0, b >= 0: the circular ones times
/// exp(-b), the hyperbolic ones times exp(-a).
template <class Z>
struct Scaled {
  Hyperbolic<RealOf<Z>> of_a, of_b;
  Z cosine, sine, cosh, sinh;
  explicit Scaled(const Z& z) : of_a(z.real()), of_b(z.imag()) {
    using std::cos;
    using std::sin;
    const RealOf<Z> a = z.real(), b = z.imag();
    const RealOf<Z> cos_a = cos(a), sin_a = sin(a), cos_b = cos(b), sin_b = sin(b);
    cosine = Z(cos_a * of_b.cosine, -sin_a * of_b.sine);
    sine = Z(sin_a * of_b.cosine, cos_a * of_b.sine);
    cosh = Z(cos_b * of_a.cosine, sin_b * of_a.sine);
    sinh = Z(cos_b * of_a.sine, sin_b * of_a.cosine);
  }
};

template <class Z>
AllFromRest<Z, 2> axial_far(const Z& q) {
  using R = RealOf<Z>;
  using std::sqrt;
  const Z gamma = sqrt(q);
  const Scaled<Z> f(gamma);
  return {{{R(1), f.sine / (gamma * f.cosine)}, {R(1), Z(f.of_b.decay) / f.cosine}}};
}

/// All products are scaled by exp(-a - b), the growth of |cosh z cos z|.
template <class Z>
AllFromRest<Z, 6> bending_far(const Z& q) {
  using R = RealOf<Z>;
  using std::sqrt;
  const Z z2 = sqrt(q), z = sqrt(z2);
  const Scaled<Z> f(z);
  const Z slow(f.of_a.decay), fast(f.of_b.decay);  // factors of circular and hyperbolic ones alone
  const Z D = slow * fast + f.cosh * f.cosine, zD = z * D, z3D = z2 * zD;
  return {{{R(1) / 3, (f.sine * f.cosh - f.cosine * f.sinh) / z3D},
           {R(1) / 2, f.sine * f.sinh / (z2 * D)},
           {R(1), (f.cosine * f.sinh + f.sine * f.cosh) / zD},
           {R(1), (f.cosine * slow + f.cosh * fast) / D},
           {R(1), (f.sine * slow + f.sinh * fast) / zD},
           {R(1) / 6, (f.sinh * fast - f.sine * slow) / z3D}}};
}

/// In the upper half plane sqrt(q) and its root have real and imaginary parts >= 0; f of the
/// conjugate of q is the conjugate of f(q).
template <class Z, class Far>
auto far_from_rest(const Z& q, Far far) {
  using std::abs;
  auto result = far(Z(q.real(), RealOf<Z>(abs(q.imag()))));
  if (q.imag() < 0)
    for (FromRest<Z>& f : result) f.value = Z(f.value.real(), RealOf<Z>(-f.value.imag()));
  return result;
}

// --- all q ---------------------------------------------------------------------------------------

template <class Z>
Axial<Z> axial(const Z& q) {
  const auto f = is_near_rest(q) ? axial_near_rest(q) : far_from_rest(q, axial_far<Z>);
  return {f[0], f[1]};
}

template <class Z>
Bending<Z> bending(const Z& q) {
  const auto f = is_near_rest(q) ? bending_near_rest(q) : far_from_rest(q, bending_far<Z>);
  return {f[0], f[1], f[2], f[3], f[4], f[5]};
}

}  // namespace titop::detail
