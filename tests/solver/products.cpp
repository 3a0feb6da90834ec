#include <doctest/doctest.h>

#include <algorithm>
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

TEST_CASE("multiply, and the same transposed: as plain loops, to the last bit, at every width") {
  Rng rng(5);
  for (const std::ptrdiff_t rows : {4, 8, 12, 20})
    for (const std::ptrdiff_t inner : {0, 1, 6, 13})
      for (const std::ptrdiff_t m : {8, 24, 48})
        for (const bool add : {false, true}) {
          const std::ptrdiff_t used = rows - (m == 24 ? 1 : 0);  // any number of rows
          const auto a = numbers(rng, rows * (inner + 2)), x = numbers(rng, inner * m),
                     start = numbers(rng, rows * m);
          std::vector<double> plain = start, transposed(start.size()), at;
          for (std::ptrdiff_t i = 0; i < rows; ++i)
            for (std::ptrdiff_t j = 0; j < m; ++j) {
              double sum = add ? start[static_cast<std::size_t>(i * m + j)] : 0;
              for (std::ptrdiff_t k = 0; k < inner; ++k)
                sum += a[static_cast<std::size_t>(i * (inner + 2) + k)] *
                       x[static_cast<std::size_t>(k * m + j)];
              if (i < used) plain[static_cast<std::size_t>(i * m + j)] = sum;
              transposed[static_cast<std::size_t>(j * rows + i)] = sum;
            }
          for (std::ptrdiff_t k = 0; k < inner; ++k)
            for (std::ptrdiff_t i = 0; i < rows; ++i)
              at.push_back(a[static_cast<std::size_t>(i * (inner + 2) + k)]);
          for (const int lanes : {8, 4, 2}) {
            INFO(rows, " x ", inner, " x ", m, ", ", lanes, " lanes");
            std::vector<double> y = start, yt(start.size());
            for (std::ptrdiff_t i = 0; i < rows; ++i)
              for (std::ptrdiff_t j = 0; j < m; ++j)
                yt[static_cast<std::size_t>(j * rows + i)] =
                    start[static_cast<std::size_t>(i * m + j)];
            titop::solve::multiply(used, inner, m, a.data(), inner + 2, x.data(), y.data(), add,
                                   lanes);
            titop::solve::multiply_transposed(rows, inner, m, at.data(), x.data(), yt.data(), rows,
                                              add, lanes);
            CHECK(y == plain);
            CHECK(yt == transposed);
          }
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
