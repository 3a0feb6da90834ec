#include <algorithm>
#include <bit>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <numeric>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scaling.hpp>

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

constexpr int kLanes = 8;  ///< columns are padded to a multiple of it: whole vectors only

/// All in one buffer: fronts are small and many.
struct Exponents {
  int rows, columns;  ///< columns with their padding, which holds exponents of 0
  boost::container::small_vector<int, 1024> buffer;
  int* e = buffer.data();       ///< of the entries as they are
  int* c = e + rows * columns;  ///< added to them: of the columns,
  int* sum = c + columns;       ///< per column: largest entry, or sum
  int* count = sum + columns;
  int* r = count + columns;  ///< of the rows

  Exponents(const double* a, int m, int n)
      : rows(m),
        columns((n + kLanes - 1) / kLanes * kLanes),
        buffer(at(m * columns + 3 * columns + m), boost::container::default_init) {
    for (int i = 0; i < m; ++i) {
      for (int j = 0; j < n; ++j) e[i * columns + j] = exponent(a[i * n + j]);
      std::fill(e + i * columns + n, e + (i + 1) * columns, kNone);
    }
    std::fill_n(c, columns, 0);
    std::fill_n(r, rows, 0);
  }
};

/// Half way towards a largest entry of 1 in every row and column.
inline void towards_one(const Exponents& x, std::span<const int> units, int* __restrict c,
                        int* __restrict sum) {
  std::fill_n(sum, x.columns, kNone);
  for (int i = 0; i < x.rows; ++i) {
    const int* __restrict row = x.e + i * x.columns, own = x.r[i];
    int top = kNone;
    for (int j = 0; j < x.columns; ++j) {
      const int entry = row[j] + c[j];
      top = std::max(top, entry);
      sum[j] = std::max(sum[j], entry + own);
    }
    if (top > kNone / 2) x.r[i] -= (top + own) / 2;
  }
  for (std::size_t k = 0; k + 1 < units.size(); ++k) {
    const int top = *std::max_element(sum + units[k], sum + units[k + 1]);
    if (top > kNone / 2)
      std::for_each(c + units[k], c + units[k + 1], [top](int& e) { e -= top / 2; });
  }
}

/// Forgets entries that are rounding beside the others.
inline void drop_rounding(const Exponents& x, const int* __restrict c) {
  for (int i = 0; i < x.rows; ++i) {
    int* __restrict row = x.e + i * x.columns, own = x.r[i];
    for (int j = 0; j < x.columns; ++j) row[j] = row[j] + own + c[j] < kRounding ? kNone : row[j];
  }
}

/// Rows, then columns, to a mean of 0.
inline void centre(const Exponents& x, std::span<const int> units, int* __restrict c,
                   int* __restrict sum, int* __restrict count) {
  std::fill_n(sum, x.columns, 0);
  std::fill_n(count, x.columns, 0);
  for (int i = 0; i < x.rows; ++i) {
    const int* __restrict row = x.e + i * x.columns;
    int total = 0, number = 0;
    for (int j = 0; j < x.columns; ++j) {
      total += row[j] > kNone / 2 ? row[j] + c[j] : 0;
      number += row[j] > kNone / 2;
    }
    if (number > 0) x.r[i] = -total / number;
    const int own = x.r[i];
    for (int j = 0; j < x.columns; ++j) {
      sum[j] += row[j] > kNone / 2 ? row[j] + own : 0;
      count[j] += row[j] > kNone / 2;
    }
  }
  for (std::size_t k = 0; k + 1 < units.size(); ++k) {
    const int total = std::accumulate(sum + units[k], sum + units[k + 1], 0);
    const int number = std::accumulate(count + units[k], count + units[k + 1], 0);
    if (number > 0) std::fill(c + units[k], c + units[k + 1], -total / number);
  }
}

TITOP_WIDE void balance(const Exponents& x, std::span<const int> units) {
  for (int round = 0; round < 4; ++round) towards_one(x, units, x.c, x.sum);
  drop_rounding(x, x.c);
  for (int round = 0; round < 3; ++round) centre(x, units, x.c, x.sum, x.count);
}

}  // namespace

void column_scale(const double* magnitudes, int rows, std::span<const int> units,
                  std::int16_t* exponents) {
  const int columns = units.back();
  const Exponents x(magnitudes, rows, columns);
  balance(x, units);
  for (int j = 0; j < columns; ++j) {
    const int rounded = (x.c[j] + (x.c[j] < 0 ? -kOne : kOne) / 2) / kOne;
    exponents[j] = static_cast<std::int16_t>(std::clamp(rounded, -1000, 1000));
  }
}

}  // namespace titop::solve
