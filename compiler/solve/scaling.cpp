#include <algorithm>
#include <bit>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <cstring>
#include <numeric>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scaling.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/wide.hpp>
#define TITOP_PART [[gnu::always_inline]] inline

namespace titop::solve {
namespace {

using Index = std::ptrdiff_t;
using linalg::at;

/// Exponents of two, in sixteenths: integers, whose sums and maxima are the same in any order and
/// on every machine.
constexpr int kOne = 16;
constexpr int kNone = -(1 << 24);  ///< the exponent of 0
constexpr int kRounding = -691;    ///< 1e-13

/// log2 of n magnitudes to within 0.09, from the bits: scaling needs exponents only. They are in
/// the upper half of a double; subnormal numbers count as 2^-1023 or a little more, and as 0 below
/// 2e-314.
TITOP_PART void exponents_of(Index n, const double* x, int* __restrict e) {
  for (Index k = 0; k < n; ++k) {
    const auto bits = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(x[k]));
    const int upper = static_cast<int>(bits >> 32);
    e[k] = upper > 0 && upper < 0x7ff00000 ? (upper >> 16) - 1023 * kOne : kNone;
  }
}

constexpr int kLanes = 8;  ///< units are padded to a multiple of it: whole vectors only
using Lanes __attribute__((vector_size(kLanes * sizeof(int)))) = int;

/// (By reference: a vector returned by value has another ABI without AVX.)
TITOP_PART void load(Lanes& to, const int* from) { std::memcpy(&to, from, sizeof to); }
TITOP_PART void store(int* to, const Lanes& from) { std::memcpy(to, &from, sizeof from); }

TITOP_PART int largest_of(const Lanes& lanes) {
  Lanes x = lanes;
  Lanes y = __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3);
  x = x > y ? x : y;
  y = __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5);
  x = x > y ? x : y;
  return std::max(x[0], x[1]);
}

TITOP_PART int sum_of(const Lanes& lanes) {
  Lanes x = lanes;
  x += __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3);
  x += __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5);
  return x[0] + x[1];
}

/// A front's exponents. The columns of a unit have one exponent: after one pass over the entries
/// the front is one of rows and units. All in one buffer: fronts are small and many. Unit u of row
/// i is at i * width + u.
struct Exponents {
  std::span<const int> units;
  Index rows, columns;
  Index count = static_cast<Index>(units.size()) - 1;
  Index width = (count + kLanes - 1) / kLanes * kLanes;  ///< units with their padding
  Index deep = 0;                                        ///< columns of the largest unit
  boost::container::small_vector<int, 2048> buffer;
  int* e = nullptr;       ///< of the entries: the first column of all units, the second ...
  int* top = nullptr;     ///< per row and unit: the largest,
  int* total = nullptr;   ///< the sum of those that count,
  int* number = nullptr;  ///< and how many they are
  int* r = nullptr;       ///< added to them: of the rows,
  int* c = nullptr;       ///< of the units
  int *a = nullptr, *b = nullptr;  ///< per unit: workspace of a round
  int* line = nullptr;             ///< exponents of one row

  Exponents(int m, std::span<const int> of_units)
      : units(of_units), rows(m), columns(units.back()) {
    for (Index u = 0; u < count; ++u) deep = std::max(deep, Index{units[at(u + 1)]} - units[at(u)]);
    const Index size = rows * width;
    const Index longer = std::max(rows, width);
    buffer.resize(at((deep + 3) * size + rows + width + 2 * longer + columns),
                  boost::container::default_init);
    e = buffer.data();
    top = e + deep * size, total = top + size, number = total + size;
    r = number + size, c = r + rows, a = c + width, b = a + longer, line = b + longer;
  }
  Exponents(const Exponents&) = delete;  // the pointers are into its own buffer
  Exponents& operator=(const Exponents&) = delete;
};

TITOP_PART void take(const Exponents& x, const double* magnitudes) {
  const Index size = x.rows * x.width;
  std::fill_n(x.e, x.deep * size, kNone);
  std::fill(x.r, x.a, 0);
  for (Index i = 0; i < x.rows; ++i) {
    exponents_of(x.columns, magnitudes + i * x.columns, x.line);
    int* to = x.e + i * x.width;
    for (Index u = 0; u < x.count; ++u, ++to)
      for (Index j = x.units[at(u)], k = 0; j < x.units[at(u + 1)]; ++j, ++k)
        to[k * size] = x.line[j];
  }
  for (Index i = 0; i < size; i += kLanes) {
    Lanes top, entry;
    load(top, x.e + i);
    for (Index k = 1; k < x.deep; ++k) {
      load(entry, x.e + k * size + i);
      top = top > entry ? top : entry;
    }
    store(x.top + i, top);
  }
}

/// exponent -= half of the largest sum with it, if there is any.
TITOP_PART void take_half(Index n, const int* __restrict largest, int* __restrict exponent) {
  for (Index i = 0; i < n; ++i) exponent[i] -= largest[i] > kNone / 2 ? largest[i] / 2 : 0;
}

/// Half way towards a largest entry of 1 in every row and column.
TITOP_PART void towards_one(const Exponents& x, int* of_rows, int* of_units) {
  for (Index i = 0; i < x.rows; ++i) {
    Lanes top = Lanes{} + kNone, entry, c;
    for (Index u = 0; u < x.width; u += kLanes) {
      load(entry, x.top + i * x.width + u);
      load(c, x.c + u);
      entry += c;
      top = top > entry ? top : entry;
    }
    of_rows[i] = largest_of(top) + x.r[i];
  }
  for (Index u = 0; u < x.width; u += kLanes) {
    Lanes top = Lanes{} + kNone, entry, c;
    load(c, x.c + u);
    for (Index i = 0; i < x.rows; ++i) {
      load(entry, x.top + i * x.width + u);
      entry += x.r[i];
      top = top > entry ? top : entry;
    }
    store(of_units + u, top + c);
  }
  take_half(x.rows, of_rows, x.r);
  take_half(x.width, of_units, x.c);
}

/// Counts the entries that are above the rounding of the others.
TITOP_PART void count_entries(const Exponents& x) {
  const Index size = x.rows * x.width;
  for (Index i = 0; i < x.rows; ++i)
    for (Index u = 0; u < x.width; u += kLanes) {
      Lanes c, entry, total{}, number{};
      load(c, x.c + u);
      for (Index k = 0; k < x.deep; ++k) {
        load(entry, x.e + k * size + i * x.width + u);
        const Lanes counts = (entry + c >= kRounding - x.r[i]) & (entry > kNone / 2);  // 0 or -1
        total += entry & counts;
        number -= counts;
      }
      store(x.total + i * x.width + u, total);
      store(x.number + i * x.width + u, number);
    }
}

/// to = -total / number, if there is any. By way of doubles, of which processors divide many at
/// once: the quotient of two ints, cut to a whole number, is the same.
TITOP_PART void take_means(Index n, const int* __restrict total, const int* __restrict number,
                           int* __restrict to) {
  for (Index i = 0; i < n; ++i) {
    const int mean = static_cast<int>(-static_cast<double>(total[i]) / std::max(number[i], 1));
    to[i] = number[i] > 0 ? mean : to[i];
  }
}

/// Rows, then columns, to a mean of 0.
TITOP_PART void centre(const Exponents& x, int* totals, int* numbers) {
  for (Index i = 0; i < x.rows; ++i) {
    Lanes row_total{}, row_number{}, total, number, c;
    for (Index u = 0; u < x.width; u += kLanes) {
      load(total, x.total + i * x.width + u);
      load(number, x.number + i * x.width + u);
      load(c, x.c + u);
      row_total += total + number * c;
      row_number += number;
    }
    totals[i] = sum_of(row_total);
    numbers[i] = sum_of(row_number);
  }
  take_means(x.rows, totals, numbers, x.r);
  for (Index u = 0; u < x.width; u += kLanes) {
    Lanes unit_total{}, unit_number{}, total, number;
    for (Index i = 0; i < x.rows; ++i) {
      load(total, x.total + i * x.width + u);
      load(number, x.number + i * x.width + u);
      unit_total += total + number * x.r[i];
      unit_number += number;
    }
    store(totals + u, unit_total);
    store(numbers + u, unit_number);
  }
  take_means(x.width, totals, numbers, x.c);
}

TITOP_WIDE void equilibrate(const Exponents& x, const double* magnitudes) {
  take(x, magnitudes);
  for (int round = 0; round < 4; ++round) towards_one(x, x.a, x.b);
  count_entries(x);
  for (int round = 0; round < 3; ++round) centre(x, x.a, x.b);
}

}  // namespace

void column_scale(const double* magnitudes, int rows, std::span<const int> units,
                  std::int16_t* exponents) {
  Exponents x(rows, units);
  equilibrate(x, magnitudes);
  for (Index u = 0; u < x.count; ++u) {
    const int rounded = (x.c[u] + (x.c[u] < 0 ? -kOne : kOne) / 2) / kOne;
    std::fill(exponents + units[at(u)], exponents + units[at(u + 1)],
              static_cast<std::int16_t>(std::clamp(rounded, -1000, 1000)));
  }
}

}  // namespace titop::solve
