#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/solve/products.hpp>
#include <vector>

#include "support/rng.hpp"

/// Products by vector registers of any width: bit by bit as by plain loops in the same order.

namespace {

using titop_test::Rng;

std::vector<double> numbers(Rng& rng, std::ptrdiff_t n) {
  std::vector<double> list(static_cast<std::size_t>(n));
  for (double& x : list) x = rng.between(-1, 1);
  return list;
}

}  // namespace

TEST_CASE("multiply: as plain loops, to the last bit, at every width") {
  Rng rng(5);
  const auto at = [](std::ptrdiff_t i) { return static_cast<std::size_t>(i); };
  for (const std::ptrdiff_t rows : {1, 4, 8, 11, 12, 20})
    for (const std::ptrdiff_t inner : {0, 1, 6, 13})
      for (const std::ptrdiff_t m : {8, 24, 40, 48}) {
        const std::ptrdiff_t y_stride = m + 3 * (inner % 2);
        const auto a = numbers(rng, rows * (inner + 2)), x = numbers(rng, 2 * inner * m),
                   start = numbers(rng, rows * y_stride);
        std::vector<double> plain = start, from_zero = start;
        std::vector<const double*> x_rows;  // some row or other between those that are read
        for (std::ptrdiff_t k = 0; k < inner; ++k) x_rows.push_back(x.data() + (2 * k + k % 2) * m);
        for (std::ptrdiff_t i = 0; i < rows; ++i)
          for (std::ptrdiff_t j = 0; j < m; ++j) {
            double sum = start[at(i * y_stride + j)], sum_from_zero = 0;
            for (std::ptrdiff_t k = 0; k < inner; ++k) {
              const double product = a[at(i * (inner + 2) + k)] * x_rows[at(k)][j];
              sum += product, sum_from_zero += product;
            }
            plain[at(i * y_stride + j)] = sum;
            from_zero[at(i * y_stride + j)] = sum_from_zero;
          }
        for (const int lanes : {8, 4, 2}) {
          INFO(rows, " x ", inner, " x ", m, ", ", lanes, " lanes");
          std::vector<double> y = start, elsewhere = start, none = start;
          const auto rows_of = [&](const std::vector<double>& of) {
            std::vector<const double*> list;
            for (std::ptrdiff_t i = 0; i < rows; ++i) list.push_back(of.data() + i * y_stride);
            return list;
          };
          const auto multiply = [&](const std::vector<double>& from, std::vector<double>& to) {
            titop::solve::multiply(rows, inner, m, a.data(), inner + 2, x_rows.data(),
                                   rows_of(from).data(), to.data(), y_stride, lanes);
          };
          multiply(y, y);
          multiply(start, elsewhere);
          titop::solve::multiply(rows, inner, m, a.data(), inner + 2, x_rows.data(), nullptr,
                                 none.data(), y_stride, lanes);
          CHECK(y == plain);
          CHECK(elsewhere == plain);
          CHECK(none == from_zero);
        }
      }
}

TEST_CASE("scale_transposed: every entry in its place, once or twice, and nothing beside") {
  Rng rng(9);
  const auto at = [](std::ptrdiff_t i) { return static_cast<std::size_t>(i); };
  for (const std::ptrdiff_t rows : {0, 1, 3, 4, 6, 9})
    for (const std::ptrdiff_t columns : {1, 2, 4, 6, 11, 16}) {
      INFO(rows, " x ", columns);
      const std::ptrdiff_t stride = columns + 3, first = 2, column = first + rows + 1;
      auto x = numbers(rng, rows * stride);
      if (rows > 0) x[0] = -0.0;
      std::vector<double> y(at(2 * columns * column), 7), plain = y;
      std::vector<titop::solve::Destination> to;
      for (std::ptrdiff_t j = 0; j < columns; ++j) {
        double* const twice = j % 3 == 0 ? nullptr : y.data() + (2 * j + 1) * column;
        to.push_back({y.data() + 2 * j * column, rng.between(0, 1), twice, rng.between(-1, 0)});
        for (std::ptrdiff_t i = 0; i < rows; ++i) {
          const double entry = x[at(i * stride + j)];
          plain[at(2 * j * column + first + i)] = to.back().by * entry;
          if (twice) plain[at((2 * j + 1) * column + first + i)] = to.back().by_second * entry;
        }
      }
      titop::solve::scale_transposed(rows, columns, x.data(), stride, to.data(), first);
      CHECK(y == plain);
      if (rows > 0) CHECK_FALSE(std::signbit(y[at(first)]));
    }
}

TEST_CASE("substitutions: as plain loops, to the last bit, at every width") {
  Rng rng(7);
  for (const std::ptrdiff_t pivots : {1, 6, 13})
    for (const std::ptrdiff_t rows : {pivots, pivots + 5})
      for (const std::ptrdiff_t m : {8, 24}) {
        const std::ptrdiff_t stride = pivots + 3;
        const auto lu = numbers(rng, rows * stride), start = numbers(rng, rows * m);
        std::vector<double> lower = start, upper = start;
        const auto at = [](std::ptrdiff_t i) { return static_cast<std::size_t>(i); };
        for (std::ptrdiff_t j = 0; j < m; ++j) {
          for (std::ptrdiff_t r = 0; r < rows; ++r)
            for (std::ptrdiff_t k = 0; k < std::min(r, pivots); ++k)
              lower[at(r * m + j)] -= lu[at(r * stride + k)] * lower[at(k * m + j)];
          for (std::ptrdiff_t r = pivots - 1; r >= 0; --r) {
            for (std::ptrdiff_t k = r + 1; k < pivots; ++k)
              upper[at(r * m + j)] -= lu[at(r * stride + k)] * upper[at(k * m + j)];
            upper[at(r * m + j)] /= lu[at(r * stride + r)];
          }
        }
        for (const int lanes : {8, 4, 2}) {
          INFO(rows, " rows, ", pivots, " pivots, ", m, " columns, ", lanes, " lanes");
          std::vector<double> x = start;
          titop::solve::substitute_lower(rows, pivots, m, lu.data(), stride, x.data(), lanes);
          CHECK(x == lower);
          x = start;
          titop::solve::substitute_upper(pivots, m, lu.data(), stride, x.data(), lanes);
          CHECK(x == upper);
        }
      }
}
