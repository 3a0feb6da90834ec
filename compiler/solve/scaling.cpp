#include <algorithm>
#include <bit>
#include <cmath>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scaling.hpp>
#include <vector>

namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Exponents of two, in sixteenths: whole numbers, whose sums and largest a compiler may take in
/// any order, and every machine gets the same.
constexpr int kOne = 16;
constexpr int kNone = -(1 << 24);  ///< the exponent of 0
constexpr int kRounding = -691;    ///< 1e-13

/// log2 to within 0.09, from the bits: exponents are all that scaling needs.
int exponent(double x) {
  if (!(x > 0) || !std::isfinite(x)) return kNone;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  return static_cast<int>(bits >> 48) - 1023 * kOne;
}

/// All in one buffer: fronts are small and many.
struct Exponents {
  int rows, columns;
  std::vector<int> buffer;
  int* e = buffer.data();       ///< of the entries as they are
  int* r = e + rows * columns;  ///< added to them: of the rows,
  int* c = r + rows;            ///< of the columns
  int* sum = c + columns;       ///< per column: largest entry, or sum
  int* count = sum + columns;

  Exponents(const double* a, int m, int n) : rows(m), columns(n), buffer(at(m * n + m + 3 * n)) {
    for (int i = 0; i < m * n; ++i) e[i] = exponent(a[i]);
  }

  /// Half way towards a largest entry of 1 in every row and column.
  void towards_one() {
    std::fill_n(sum, columns, kNone);
    for (int i = 0; i < rows; ++i) {
      const int *row = e + i * columns, own = r[i];
      int top = kNone;
      for (int j = 0; j < columns; ++j) {
        const int entry = row[j] + c[j];
        top = std::max(top, entry);
        sum[j] = std::max(sum[j], entry + own);
      }
      if (top > kNone / 2) r[i] -= (top + own) / 2;
    }
    for (int j = 0; j < columns; ++j)
      if (sum[j] > kNone / 2) c[j] -= sum[j] / 2;
  }

  /// Forgets entries that are rounding beside the others.
  void drop_rounding() {
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j) {
        int& x = e[i * columns + j];
        x = x + r[i] + c[j] < kRounding ? kNone : x;
      }
  }

  /// Rows, then columns, to a mean of 0.
  void centre() {
    std::fill_n(sum, columns, 0);
    std::fill_n(count, columns, 0);
    for (int i = 0; i < rows; ++i) {
      const int* row = e + i * columns;
      int total = 0, number = 0;
      for (int j = 0; j < columns; ++j) {
        total += row[j] > kNone / 2 ? row[j] + c[j] : 0;
        number += row[j] > kNone / 2;
      }
      if (number > 0) r[i] = -total / number;
      const int own = r[i];
      for (int j = 0; j < columns; ++j) {
        sum[j] += row[j] > kNone / 2 ? row[j] + own : 0;
        count[j] += row[j] > kNone / 2;
      }
    }
    for (int j = 0; j < columns; ++j)
      if (count[j] > 0) c[j] = -sum[j] / count[j];
  }
};

TITOP_WIDE void balance(Exponents& x) {
  for (int round = 0; round < 4; ++round) x.towards_one();
  x.drop_rounding();
  for (int round = 0; round < 3; ++round) x.centre();
}

}  // namespace

void column_scale(const double* magnitudes, int rows, int columns, std::int16_t* exponents) {
  Exponents x(magnitudes, rows, columns);
  balance(x);
  for (int j = 0; j < columns; ++j) {
    const int rounded = (x.c[j] + (x.c[j] < 0 ? -kOne : kOne) / 2) / kOne;
    exponents[j] = static_cast<std::int16_t>(std::clamp(rounded, -1000, 1000));
  }
}

}  // namespace titop::solve
