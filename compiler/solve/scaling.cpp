#include <algorithm>
#include <bit>
#include <cmath>
#include <titop/compiler/solve/scaling.hpp>

namespace titop::solve {
namespace {

constexpr float kNone = -1e30F;  ///< the exponent of 0

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// log2 to within 0.09, from the bits: exponents are all that scaling needs.
float exponent(double x) {
  if (!(x > 0) || !std::isfinite(x)) return kNone;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const auto mantissa = static_cast<float>(bits & 0xFFFFFFFFFFFFFull) * 0x1p-52F;
  return static_cast<float>(static_cast<int>(bits >> 52)) - 1023.0F + mantissa;
}

struct Exponents {
  int rows, columns;
  std::vector<float> e;     ///< of the entries as they are
  std::vector<float> r, c;  ///< added to them: of the rows, of the columns

  Exponents(const double* a, int m, int n) : rows(m), columns(n), e(at(m * n)), r(at(m)), c(at(n)) {
    for (std::size_t i = 0; i < e.size(); ++i) e[i] = exponent(a[i]);
  }

  /// Half way towards a largest entry of 1 in every row and column.
  void towards_one() {
    std::vector<float> largest(at(columns), kNone);
    for (int i = 0; i < rows; ++i) {
      const float* row = e.data() + i * columns;
      float top = kNone;
      for (int j = 0; j < columns; ++j) {
        top = std::max(top, row[j] + c[at(j)]);
        largest[at(j)] = std::max(largest[at(j)], row[j] + r[at(i)] + c[at(j)]);
      }
      if (top > kNone / 2) r[at(i)] -= (top + r[at(i)]) / 2;
    }
    for (int j = 0; j < columns; ++j)
      if (largest[at(j)] > kNone / 2) c[at(j)] -= largest[at(j)] / 2;
  }

  /// Forgets entries that are rounding beside the others.
  void drop_rounding() {
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j)
        if (float& x = e[at(i * columns + j)]; x + r[at(i)] + c[at(j)] < -43.2F) x = kNone;
  }

  /// Rows, then columns, to a mean of 0.
  void centre() {
    std::vector<float> sum(at(columns), 0), count(at(columns), 0);
    for (int i = 0; i < rows; ++i) {
      const float* row = e.data() + i * columns;
      float total = 0, number = 0;
      for (int j = 0; j < columns; ++j)
        if (row[j] > kNone / 2) total += row[j] + c[at(j)], ++number;
      if (number > 0) r[at(i)] = -total / number;
      for (int j = 0; j < columns; ++j)
        if (row[j] > kNone / 2) sum[at(j)] += row[j] + r[at(i)], ++count[at(j)];
    }
    for (int j = 0; j < columns; ++j)
      if (count[at(j)] > 0) c[at(j)] = -sum[at(j)] / count[at(j)];
  }
};

}  // namespace

std::vector<std::int16_t> column_scale(const double* magnitudes, int rows, int columns) {
  Exponents x(magnitudes, rows, columns);
  for (int round = 0; round < 4; ++round) x.towards_one();
  x.drop_rounding();
  for (int round = 0; round < 3; ++round) x.centre();
  std::vector<std::int16_t> result(at(columns));
  for (int j = 0; j < columns; ++j)
    result[at(j)] = static_cast<std::int16_t>(std::lround(std::clamp(x.c[at(j)], -1000.F, 1000.F)));
  return result;
}

}  // namespace titop::solve
