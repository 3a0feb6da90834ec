#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/row_sums.hpp>
#include <vector>

#include "support/rng.hpp"

/// Sums of rows by vector registers of any width, bit by bit as by plain loops, and quotients of
/// complex numbers against long double.

namespace {

using titop_test::Rng;

void draw(Rng& rng, double& x) { x = rng.between(-1, 1); }
void draw(Rng& rng, std::complex<double>& x) {
  const double re = rng.between(-1, 1);
  x = {re, rng.between(-1, 1)};
}

/// Every third of the factors is 0.
template <class T>
void check_sums() {
  Rng rng(11);
  const auto at = [](std::ptrdiff_t i) { return static_cast<std::size_t>(i); };
  for (const std::ptrdiff_t count : {0, 1, 6, 13})
    for (const std::ptrdiff_t m : {1, 2, 3, 6, 7, 12, 17, 40}) {
      std::vector<T> l(at(count)), x(at(count * m)), y(at(m));
      for (auto* list : {&l, &x, &y})
        for (T& entry : *list) draw(rng, entry);
      for (std::ptrdiff_t k = 0; k < count; k += 3) {
        l[at(k)] = T(0);  // x is not read for a factor of 0
        x[at(k * m)] = std::numeric_limits<double>::infinity();
      }
      std::vector<T> plain = y;
      for (std::ptrdiff_t k = 0; k < count; ++k)
        if (l[at(k)] != T(0))
          for (std::ptrdiff_t j = 0; j < m; ++j)
            titop::solve::subtract(1, l[at(k)], &x[at(k * m + j)], &plain[at(j)]);
      for (const int lanes : {8, 4, 2}) {
        INFO(count, " rows of ", m, ", ", lanes, " lanes");
        std::vector<T> sum = y;
        titop::solve::subtract_sum(count, l.data(), x.data(), m, sum.data(), lanes);
        CHECK(sum == plain);
      }
    }
}

}  // namespace

TEST_CASE("subtract_sum: as plain loops, to the last bit, at every width") {
  check_sums<double>();
  check_sums<std::complex<double>>();
}

TEST_CASE("divisor: complex quotients to a few units of the last place, whatever the magnitudes") {
  Rng rng(3);
  for (int i = 0; i < 4000; ++i) {
    // Real and imaginary parts may differ by as much as they like.
    const auto number = [&] {
      const auto any = [&] {
        const double mantissa = rng.between(-1, 1);
        return mantissa * std::pow(10, rng.between(-140, 140));
      };
      const double re = any();
      return std::complex<double>(re, i % 2 ? rng.between(-1, 1) * std::abs(re) : any());
    };
    const std::complex<double> a = number(), b = number();
    const std::complex<double> found = titop::solve::Divisor<std::complex<double>>(b)(a);
    const std::complex<long double> exact =
        std::complex<long double>(a) / std::complex<long double>(b);
    CAPTURE(a);
    CAPTURE(b);
    // Nothing cancels in the denominator (at most 2 units of rounding, half an epsilon each); with
    // 3 of the numerator's, over its modulus, and the division's own that is 3 epsilon.
    CHECK(static_cast<double>(std::abs(std::complex<long double>(found) - exact) /
                              std::abs(exact)) <= 3 * std::numeric_limits<double>::epsilon());
  }
}

TEST_CASE("divisor: by a real or an imaginary number nothing but the one division is rounded") {
  const titop::solve::Divisor<std::complex<double>> three({3, 0}), three_j({0, 3});
  CHECK(three({1, 2}) == std::complex<double>(1.0 / 3, 2.0 / 3));
  CHECK(three_j({1, 2}) == std::complex<double>(2.0 / 3, -1.0 / 3));
  CHECK(titop::solve::Divisor<double>(3)(1) == 1.0 / 3);
}
