#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <complex>
#include <limits>

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__)
#error "double-double stores rounding errors: compile without -ffast-math"
#endif

namespace titop::solve {

static_assert(FLT_EVAL_METHOD == 0, "double-double needs every operation rounded to double");

/// A number of 32 digits as the sum of two doubles, the second at most half a unit of the last
/// place of the first [Dekker 1971, Knuth]: some twenty operations of doubles per sum or product,
/// where a number of 50 digits takes hundreds. Rounding of one operation: at most 2^-104.
///
/// The range of operands and results is less than that of double: above 2^995 (3e299) it may become
/// NaN, below 2^-967 (8e-292) it loses the second double.
class DoubleDouble {
 public:
  DoubleDouble() = default;
  DoubleDouble(double x) : high_(x) {}  // as other scalars: doubles are exact in it
  explicit operator double() const { return high_ + low_; }

  DoubleDouble operator-() const { return {-high_, -low_}; }

  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    DoubleDouble sum = exact_sum(a.high_, b.high_);
    const DoubleDouble rest = exact_sum(a.low_, b.low_);
    sum = ordered_sum(sum.high_, sum.low_ + rest.high_);
    return ordered_sum(sum.high_, sum.low_ + rest.low_);
  }
  friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble p = exact_product(a.high_, b.high_);
    return ordered_sum(p.high_, p.low_ + (a.high_ * b.low_ + a.low_ * b.high_));
  }
  /// Long division, three digits to the base 2^53: with two the rounding is twice as large.
  friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.high_ / b.high_;
    DoubleDouble left = a - b * first;
    const double second = left.high_ / b.high_;
    left = left - b * second;
    return ordered_sum(first, second) + left.high_ / b.high_;
  }

  DoubleDouble& operator+=(const DoubleDouble& b) { return *this = *this + b; }
  DoubleDouble& operator-=(const DoubleDouble& b) { return *this = *this - b; }
  DoubleDouble& operator*=(const DoubleDouble& b) { return *this = *this * b; }
  DoubleDouble& operator/=(const DoubleDouble& b) { return *this = *this / b; }

  friend bool operator==(const DoubleDouble& a, const DoubleDouble& b) {
    return a.high_ == b.high_ && a.low_ == b.low_;
  }
  friend bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
    return a.high_ < b.high_ || (a.high_ == b.high_ && a.low_ < b.low_);
  }
  friend DoubleDouble abs(const DoubleDouble& a) { return a.high_ < 0 ? -a : a; }
  /// a 2^e.
  friend DoubleDouble ldexp(const DoubleDouble& a, int e) {
    return {std::ldexp(a.high_, e), std::ldexp(a.low_, e)};
  }

 private:
  DoubleDouble(double high, double low) : high_(high), low_(low) {}

  /// a + b; |a| >= |b| or a = 0.
  static DoubleDouble ordered_sum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
  }
  static DoubleDouble exact_sum(double a, double b) {
    const double sum = a + b, of_b = sum - a;
    return {sum, (a - (sum - of_b)) + (b - of_b)};
  }
  static DoubleDouble exact_product(double a, double b) {
    const double product = a * b;
#ifdef __FP_FAST_FMA
    return {product, std::fma(a, b, -product)};
#else
    const DoubleDouble x = halves(a), y = halves(b);  // the same bits, without a call per product
    return {product, ((x.high_ * y.high_ - product) + x.high_ * y.low_ + x.low_ * y.high_) +
                         x.low_ * y.low_};
#endif
  }
  /// Two numbers of 26 bits each: their products are exact. NaN above 1e300.
  static DoubleDouble halves(double a) {
    const double far = 134217729.0 * a;  // 2^27 + 1
    const double high = far - (far - a);
    return {high, a - high};
  }

  double high_ = 0, low_ = 0;
};

/// z scaled to near 1 by a power of two; `exponent`: of the removed factor.
inline std::complex<DoubleDouble> near_one(const std::complex<DoubleDouble>& z, int& exponent) {
  const auto size = [](const DoubleDouble& x) { return std::abs(static_cast<double>(x)); };
  std::frexp(std::max(size(z.real()), size(z.imag())), &exponent);
  return {ldexp(z.real(), -exponent), ldexp(z.imag(), -exponent)};
}

/// The standard defines complex numbers of its own types only, and its libraries square the divisor
/// unscaled: beyond double-double's range no digit remains. Here the range is that of double, for
/// any numerator and divisor. Found by argument-dependent lookup.
inline std::complex<DoubleDouble> operator/(const std::complex<DoubleDouble>& a,
                                            const std::complex<DoubleDouble>& b) {
  int up = 0, down = 0;
  const std::complex<DoubleDouble> x = near_one(a, up), y = near_one(b, down);
  const DoubleDouble re = y.real(), im = y.imag(), square = re * re + im * im;
  return {ldexp((x.real() * re + x.imag() * im) / square, up - down),
          ldexp((x.imag() * re - x.real() * im) / square, up - down)};
}
inline std::complex<DoubleDouble>& operator/=(std::complex<DoubleDouble>& a,
                                              const std::complex<DoubleDouble>& b) {
  return a = a / b;
}

}  // namespace titop::solve

template <>
class std::numeric_limits<titop::solve::DoubleDouble> : public std::numeric_limits<double> {
 public:
  static constexpr bool is_iec559 = false;
  static constexpr int digits = 105, digits10 = 31, max_digits10 = 33;
  static titop::solve::DoubleDouble epsilon() { return 0x1p-104; }
};

/// @cond  Doxygen finds no scope for declarations in a namespace that is not the project's.
template <>
struct Eigen::NumTraits<titop::solve::DoubleDouble>
    : Eigen::GenericNumTraits<titop::solve::DoubleDouble> {
  enum { AddCost = 20, MulCost = 30 };
};
/// @endcond
