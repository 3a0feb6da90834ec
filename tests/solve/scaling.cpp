#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <titop/compiler/solve/scaling.hpp>
#include <utility>
#include <vector>

#include "support/rng.hpp"

/// The scale of a front's columns. Of magnitudes 2^(p_i + q_j) the columns are equal once column j
/// has been multiplied by 2^-q_j: exponents differ by q_k - q_j, for any p.

using titop::solve::column_scale;
using titop_test::Rng;

namespace {

struct Front {
  int rows = 0;
  std::vector<double> entries;  ///< row by row
  std::vector<int> units;       ///< first columns, and the end

  int columns() const { return units.back(); }
  double& operator()(int i, int j) { return entries[static_cast<std::size_t>(i * columns() + j)]; }
};

Front zeros(int rows, const std::vector<int>& units) {
  return {rows, std::vector<double>(static_cast<std::size_t>(rows * units.back())), units};
}

std::vector<int> scalars(int columns) {
  std::vector<int> units;
  for (int j = 0; j <= columns; ++j) units.push_back(j);
  return units;
}

std::vector<int> exponents(const Front& f) {
  std::vector<std::int16_t> result(static_cast<std::size_t>(f.columns()));
  column_scale(f.entries.data(), f.rows, f.units, result.data());
  return {result.begin(), result.end()};
}

/// The same less the first one.
std::vector<int> differences(const Front& f) {
  std::vector<int> result = exponents(f);
  for (std::size_t j = result.size(); j-- > 0;) result[j] -= result[0];
  return result;
}

/// 2^(p_i + q_j)
Front powers(const std::vector<int>& p, const std::vector<int>& q) {
  Front f = zeros(static_cast<int>(p.size()), scalars(static_cast<int>(q.size())));
  for (int i = 0; i < f.rows; ++i)
    for (int j = 0; j < f.columns(); ++j)
      f(i, j) = std::ldexp(1, p[static_cast<std::size_t>(i)] + q[static_cast<std::size_t>(j)]);
  return f;
}

Front diagonal(const std::vector<double>& entries) {
  const int n = static_cast<int>(entries.size());
  Front f = zeros(n, scalars(n));
  for (int i = 0; i < n; ++i) f(i, i) = entries[static_cast<std::size_t>(i)];
  return f;
}

}  // namespace

TEST_CASE("column scale: products of powers of two by rows and by columns") {
  CHECK(differences(powers({0, 3, -5}, {0, 7, -20, 4})) == std::vector<int>{0, -7, 20, -4});
  // More columns than a vector has lanes.
  Rng rng(1);
  for (const int n : {1, 2, 7, 8, 9, 30}) {
    std::vector<int> p, q, expected;
    for (int i = 0; i < n; ++i) p.push_back(static_cast<int>(rng.between(-60, 60)));
    for (int i = 0; i < n + 3; ++i) q.push_back(static_cast<int>(rng.between(-60, 60)));
    for (const int x : q) expected.push_back(q[0] - x);
    CHECK(differences(powers(p, q)) == expected);
  }
}

TEST_CASE("column scale: alone in its row an entry is shared by row and column") {
  CHECK(exponents(diagonal({0x1p10, 0x1p-6, 1})) == std::vector<int>{-5, 3, 0});
  // log2(1e300) = 996.6
  CHECK(exponents(diagonal({1e300, 1e-300})) == std::vector<int>{-498, 498});
}

TEST_CASE("column scale: columns of zeros stay as they are, and move no other") {
  const std::vector<int> p{2, -9, 4}, q{0, 11, -3};
  const std::vector<int> alone = exponents(powers(p, q));
  Front f = zeros(4, scalars(5));  // columns 1 and 3 are 0, and so is row 2
  for (const auto& [j, from] : {std::pair(0, 0), std::pair(2, 1), std::pair(4, 2)})
    for (const auto& [i, row] : {std::pair(0, 0), std::pair(1, 1), std::pair(3, 2)})
      f(i, j) = powers(p, q)(row, from);
  CHECK(exponents(f) == std::vector<int>{alone[0], 0, alone[1], 0, alone[2]});
  CHECK(exponents(zeros(3, scalars(3))) == std::vector<int>(3, 0));
}

TEST_CASE("column scale: at the ends of the range of a double") {
  using Limits = std::numeric_limits<double>;
  // Half of 1023 and of 1022, up or down: subnormal numbers count as hardly smaller.
  const std::vector<int> subnormal =
      exponents(diagonal({Limits::min(), Limits::min() / 8, 2e-310}));
  for (const int e : subnormal) CHECK(std::abs(e - 511) <= 1);
  // Values with next to no digits left, and values that are not finite, count as no entry.
  CHECK(exponents(diagonal({1e-314, Limits::denorm_min(), Limits::infinity(),
                            Limits::quiet_NaN()})) == std::vector<int>(4, 0));
  CHECK(exponents(diagonal({Limits::max()})) == std::vector<int>{-512});
  // In one row 2^1993 apart: no column becomes infinite or 0 by its scale.
  Front row = zeros(1, scalars(2));
  row(0, 0) = 1e300, row(0, 1) = 1e-300;
  const std::vector<int> far = exponents(row);
  for (int j = 0; j < 2; ++j) {
    const double scaled = std::ldexp(row(0, j), far[static_cast<std::size_t>(j)]);
    CHECK(std::isfinite(scaled));
    CHECK(scaled >= 1e-300);
    CHECK(std::abs(far[static_cast<std::size_t>(j)]) <= 1000);
  }
}

TEST_CASE("column scale: threes share an exponent, whichever way their frame is turned") {
  // A wrench of forces and torques, and a scalar between: 2^(p_i + q of the unit) times three
  // components, none above 1.
  const std::vector<int> units{0, 3, 4, 7}, q{0, 12, -7}, p{3, -4, 0, 5};
  const double component[] = {1, 0.5, 0x1p-30};
  const auto turned = [&](int by) {
    Front f = zeros(4, units);
    for (int i = 0; i < 4; ++i)
      for (std::size_t u = 0; u < 3; ++u)
        for (int j = units[u], k = 0; j < units[u + 1]; ++j, ++k) {
          const double share = units[u + 1] - units[u] == 1 ? 1 : component[(k + by) % 3];
          f(i, j) = share * std::ldexp(1, p[static_cast<std::size_t>(i)] + q[u]);
        }
    return exponents(f);
  };
  const std::vector<int> e = turned(0);
  for (const int j : {1, 2}) CHECK(e[static_cast<std::size_t>(j)] == e[0]);
  for (const int j : {5, 6}) CHECK(e[static_cast<std::size_t>(j)] == e[4]);
  CHECK(e[0] - e[4] == q[2] - q[0]);  // equal up to their units
  CHECK(turned(1) == e);
  CHECK(turned(2) == e);
}

TEST_CASE("column scale: rows in other units change no column beside another") {
  // Four halvings leave a sixteenth of 2^200, and so no entry of 1e-4 below the 1e-13 that count:
  // the means of all entries by columns, less a common one.
  Rng rng(2);
  for (int round = 0; round < 100; ++round) {
    const int rows = 1 + round % 12, columns = 1 + round % 17;
    Front f = zeros(rows, scalars(columns));
    for (double& x : f.entries) x = std::pow(10, rng.between(-2, 2));
    Front other = f;
    for (int i = 0; i < rows; ++i) {
      const int power = static_cast<int>(rng.between(-100, 100));
      for (int j = 0; j < columns; ++j) other(i, j) = std::ldexp(f(i, j), power);
    }
    const std::vector<int> e = exponents(f), o = exponents(other);
    int least = 1000, most = -1000;
    for (std::size_t j = 0; j < e.size(); ++j) {
      least = std::min(least, o[j] - e[j]);
      most = std::max(most, o[j] - e[j]);
    }
    CHECK(most - least <= 1);  // by a common power, rounded to whole ones
  }
}
