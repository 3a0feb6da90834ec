#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <titop/compiler/solve/double_double.hpp>

#include "oracle.hpp"
#include "support/random_scene.hpp"

/// Sums, products and quotients of two doubles each, against 150 digits.

using namespace solver_test;
using titop::solve::DoubleDouble;
using titop_test::Rng;

namespace {

/// A number of 32 digits, and the same in 150.
struct Both {
  DoubleDouble x;
  Real exact;
};

Both random(Rng& rng) {
  const double sign = rng.chance(0.5) ? 1 : -1;
  const double high = sign * rng.octaves(-60, 60), low = high * 0x1p-54 * rng.between(-1, 1);
  return {DoubleDouble(high) + low, Real(high) + Real(low)};
}

Real exact_of(const DoubleDouble& x) {
  const double high = static_cast<double>(x);
  return Real(high) + Real(static_cast<double>(x - high));
}

/// Over what the operation's numbers are.
double error(const DoubleDouble& found, const Real& exact, const Real& size) {
  return static_cast<double>(abs(exact_of(found) - exact) / size);
}

constexpr double kUnit = 0x1p-104;

}  // namespace

TEST_CASE("double-double: each operation is right to a few units of 2^-104") {
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
  CHECK(sum <= 2 * kUnit);
  CHECK(difference <= 2 * kUnit);
  CHECK(product <= 8 * kUnit);
  CHECK(quotient <= 16 * kUnit);
  CHECK(sum > 0);  // 150 digits see more than 32
}

TEST_CASE("double-double: numbers that cancel leave what is exact") {
  const DoubleDouble third = DoubleDouble(1) / 3.0;
  CHECK(error(third, Real(1) / 3, Real(1) / 3) <= kUnit);
  CHECK(static_cast<double>(third * 3.0 - 1.0) == doctest::Approx(0).epsilon(kUnit));
  const DoubleDouble x = DoubleDouble(1) + 0x1p-80;
  CHECK(static_cast<double>(x - 1.0) == 0x1p-80);
  CHECK(1.0 < x);
  CHECK(x == DoubleDouble(1) + 0x1p-80);
  CHECK(static_cast<double>(abs(-x) - x) == 0);
}

TEST_CASE("double-double: complex numbers of it, as the solver has them") {
  using Number = std::complex<DoubleDouble>;
  const Number a(DoubleDouble(1) / 3.0, 2.0), b(0.1, DoubleDouble(-1) / 7.0);
  const Number q = a / b * b - a;
  CHECK(std::abs(static_cast<double>(q.real())) <= 32 * kUnit);
  CHECK(std::abs(static_cast<double>(q.imag())) <= 32 * kUnit);
}

TEST_CASE("double-double: what overflows is no number") {
  const DoubleDouble large(1e200);
  CHECK(std::isnan(static_cast<double>(large * large)));
  CHECK(
      !std::isfinite(static_cast<double>(DoubleDouble(std::numeric_limits<double>::max()) * 2.0)));
}
