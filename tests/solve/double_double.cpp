#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <titop/compiler/solve/double_double.hpp>

#include "oracle.hpp"
#include "support/rng.hpp"

/// Sums, products and quotients of numbers of two doubles each, against 150 digits.

using namespace solve_test;
using titop::solve::DoubleDouble;
using titop_test::Rng;

namespace {

/// A number of 32 digits, and the same in 150.
struct Both {
  DoubleDouble x;
  Real exact;
};

Both random(Rng& rng, int least = -60, int most = 60) {
  const double sign = rng.chance(0.5) ? 1 : -1;
  const double high = sign * rng.octaves(least, most), low = high * 0x1p-54 * rng.between(-1, 1);
  return {DoubleDouble(high) + low, Real(high) + Real(low)};
}

Real exact_of(const DoubleDouble& x) {
  const double high = static_cast<double>(x);
  return Real(high) + Real(static_cast<double>(x - high));
}

/// Error relative to the size of the operands.
double error(const DoubleDouble& found, const Real& exact, const Real& size) {
  return static_cast<double>(abs(exact_of(found) - exact) / size);
}

constexpr double kUnit = 0x1p-104;

/// Largest error of products and quotients of numbers of `most` bits at most, whose results have as
/// many.
double worst_error(Rng& rng, int most) {
  double worst = 0;
  for (int i = 0; i < 5000; ++i) {
    const Both a = random(rng, most - 1, most), b = random(rng, -1, 0),
               half = random(rng, most / 2 - 1, most / 2);
    for (const auto& [found, exact] :
         {std::pair(a.x * b.x, a.exact * b.exact), std::pair(a.x / b.x, a.exact / b.exact),
          std::pair(half.x * half.x, half.exact * half.exact)}) {
      const double off = error(found, exact, abs(exact));
      if (!(off <= worst)) worst = off;
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("double-double: each operation is right to 2^-104") {
  Rng rng(5);
  double sum = 0, difference = 0, product = 0, quotient = 0;
  for (int i = 0; i < 20000; ++i) {
    const Both a = random(rng), b = random(rng);
    REQUIRE(exact_of(a.x) == a.exact);
    const Real size = abs(a.exact) + abs(b.exact);
    sum = std::max(sum, error(a.x + b.x, a.exact + b.exact, size));
    difference = std::max(difference, error(a.x - b.x, a.exact - b.exact, size));
    product = std::max(product, error(a.x * b.x, a.exact * b.exact, abs(a.exact * b.exact)));
    quotient = std::max(quotient, error(a.x / b.x, a.exact / b.exact, abs(a.exact / b.exact)));
  }
  CHECK(sum <= 0.6 * kUnit);
  CHECK(difference <= 0.6 * kUnit);
  CHECK(product <= 0.8 * kUnit);
  CHECK(quotient <= 0.6 * kUnit);  // of two digits in place of three: 0.9
  CHECK(sum > 0);                  // 150 digits resolve more than 32
}

TEST_CASE("double-double: the range that is promised has all digits, and ends there") {
  Rng rng(6);
  CHECK(worst_error(rng, 994) <= 0.8 * kUnit);
  CHECK(worst_error(rng, -965) <= 0.8 * kUnit);
  CHECK(worst_error(rng, -1000) > 100 * kUnit);
}

TEST_CASE("double-double: cancellation leaves the exact difference") {
  const DoubleDouble third = DoubleDouble(1) / 3.0;
  CHECK(error(third, Real(1) / 3, Real(1) / 3) <= kUnit);
  CHECK(std::abs(static_cast<double>(third * 3.0 - 1.0)) <= kUnit);
  const DoubleDouble x = DoubleDouble(1) + 0x1p-80;
  CHECK(static_cast<double>(x - 1.0) == 0x1p-80);
  CHECK(1.0 < x);
  CHECK(x == DoubleDouble(1) + 0x1p-80);
  CHECK(static_cast<double>(abs(-x) - x) == 0);
}

namespace {

using Number = std::complex<DoubleDouble>;

struct BothComplex {
  Number x;
  Complex exact;
};

BothComplex random_complex(Rng& rng, int least, int most) {
  const Both re = random(rng, least, most), im = random(rng, least, most);
  return {{re.x, im.x}, Complex(re.exact, im.exact)};
}

double error(const Number& found, const Complex& exact) {
  const auto size = [](const Complex& z) { return Real(sqrt(z.re * z.re + z.im * z.im)); };
  const Complex off = Complex(exact_of(found.real()), exact_of(found.imag())) - exact;
  return static_cast<double>(size(off) / size(exact));
}

}  // namespace

TEST_CASE("double-double: complex quotients have all digits as far as double reaches") {
  Rng rng(8);
  double worst = 0;
  for (const int of_divisor : {-1020, -960, -540, -490, -60, 0, 60, 490, 540, 990, 1020})
    for (const int of_quotient : {-900, -500, -30, 0, 30, 500, 1000}) {
      const int of_dividend = of_divisor + of_quotient;
      if (of_dividend < -960 || of_dividend > 1020) continue;  // it has not all digits itself
      for (int i = 0; i < 200; ++i) {
        const BothComplex a = random_complex(rng, of_dividend - 3, of_dividend + 3);
        BothComplex b = random_complex(rng, of_divisor - 1, of_divisor + 3);
        if (of_divisor < -960)  // nor has the divisor
          b.exact = Complex(exact_of(b.x.real()), exact_of(b.x.imag()));
        const double off = error(a.x / b.x, a.exact / b.exact);
        if (!(off <= worst)) worst = off;
        Number c = a.x;
        c /= b.x;
        const bool same = c == a.x / b.x;
        REQUIRE(same);
      }
    }
  CHECK(worst <= 1.5 * kUnit);
}

TEST_CASE("double-double: an overflow is not a number") {
  const DoubleDouble large(1e200);
  CHECK(std::isnan(static_cast<double>(large * large)));
  CHECK(
      !std::isfinite(static_cast<double>(DoubleDouble(std::numeric_limits<double>::max()) * 2.0)));
  for (const Number& q : {Number(1) / Number(0), Number(1e300) / Number(0, 1e-300)})
    CHECK(!std::isfinite(static_cast<double>(q.real()) + static_cast<double>(q.imag())));
  CHECK(!std::numeric_limits<DoubleDouble>::is_iec559);
}
