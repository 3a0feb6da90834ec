#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>

/// Steps of elimination on a front: rows x n entries, row-major, and `bounds`, as many, for the
/// sums of the magnitudes of the terms of entries. For double and its complex numbers in the
/// widest vectors that the processor has (front_elimination.cpp); the same bits on every machine.
namespace titop::solve {

/// The largest of n numbers of which none is negative; NaN, of any sign bit, is above all others.
/// By their bits: integers may be compared in any order.
template <class Entry>
inline double largest_of(std::ptrdiff_t n, Entry entry) {
  std::int64_t most = 0;
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    const auto bits =
        std::bit_cast<std::int64_t>(entry(j)) & std::numeric_limits<std::int64_t>::max();
    most = bits > most ? bits : most;
  }
  return std::bit_cast<double>(most);
}

/// Losses up to this are ordinary: they must not add up from row to row of a wide front (as a
/// product they would grow exponentially with its width), nor along a chain of fronts.
constexpr double kOrdinaryLoss = 1e-6;

/// The magnitude of an entry of a pivot row in the sums of others: its own, or that of its terms if
/// it has lost more than is ordinary.
inline double pivot_row_magnitude(double size, double bound) {
  return size > kOrdinaryLoss * bound ? size : bound;
}

/// One step of elimination in a rows x n array: below row k, right of column k up to column `end`.
/// `bounds` gets the sums of magnitudes |a| + sum |l| |u| [Higham 2002, theorem 9.3].
template <class T, class Size>
[[gnu::always_inline]] inline void eliminate_below(std::ptrdiff_t k, std::ptrdiff_t end,
                                                   std::ptrdiff_t rows, std::ptrdiff_t n, T* a,
                                                   double* bounds, Size size) {
  const T* from = a + k * n + k;
  const Divisor<T> over(from[0]);
  double* const bound = bounds + k * n + k + 1;
  const std::ptrdiff_t right = end - k - 1;
  for (std::ptrdiff_t j = 0; j < right; ++j)
    bound[j] = pivot_row_magnitude(size(from[j + 1]), bound[j]);
  for (std::ptrdiff_t i = k + 1; i < rows; ++i) {
    T* to = a + i * n + k;
    if (to[0] == T(0)) continue;
    const T l = over(to[0]);
    to[0] = l;
    subtract(right, l, from + 1, to + 1);
    add(right, size(l), bound, bounds + i * n + k + 1);
  }
}

/// Steps k ... end - 1, done up to column `end`, continue in N columns from j on: a row's sums stay
/// in registers, step by step, with the same bits as whole steps.
template <std::size_t N, class T, class Size>
[[gnu::always_inline]] inline void eliminate_columns(std::ptrdiff_t k, std::ptrdiff_t end,
                                                     std::ptrdiff_t rows, std::ptrdiff_t n,
                                                     std::ptrdiff_t j, T* a, double* bounds,
                                                     Size size) {
  for (std::ptrdiff_t i = k; i < rows; ++i) {
    T y[N];
    double bound[N];
    std::copy_n(a + i * n + j, N, y);
    std::copy_n(bounds + i * n + j, N, bound);
    for (std::ptrdiff_t p = k; p < (i < end ? i : end); ++p) {
      const T l = a[i * n + p];
      if (l == T(0)) continue;
      subtract(N, l, a + p * n + j, y);
      add(N, size(l), bounds + p * n + j, bound);
    }
    if (i < end)  // a pivot row
      for (std::size_t c = 0; c < N; ++c) bound[c] = pivot_row_magnitude(size(y[c]), bound[c]);
    std::copy_n(y, N, a + i * n + j);
    std::copy_n(bound, N, bounds + i * n + j);
  }
}

/// The same in all columns from `end` on.
template <class T, class Size>
[[gnu::always_inline]] inline void eliminate_right(std::ptrdiff_t k, std::ptrdiff_t end,
                                                   std::ptrdiff_t rows, std::ptrdiff_t n, T* a,
                                                   double* bounds, Size size) {
  std::ptrdiff_t j = end;
  for (; j + 16 <= n; j += 16) eliminate_columns<16>(k, end, rows, n, j, a, bounds, size);
  for (; j + 4 <= n; j += 4) eliminate_columns<4>(k, end, rows, n, j, a, bounds, size);
  for (; j < n; ++j) eliminate_columns<1>(k, end, rows, n, j, a, bounds, size);
}

/// For any other scalar.
template <class T>
void eliminate_below(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows, std::ptrdiff_t n,
                     T* a, double* bounds) {
  eliminate_below(k, end, rows, n, a, bounds, size_of<T>);
}
void eliminate_below(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows, std::ptrdiff_t n,
                     double* a, double* bounds);
void eliminate_below(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows, std::ptrdiff_t n,
                     std::complex<double>* a, double* bounds);

template <class T>
void eliminate_right(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows, std::ptrdiff_t n,
                     T* a, double* bounds) {
  eliminate_right(k, end, rows, n, a, bounds, size_of<T>);
}
void eliminate_right(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows, std::ptrdiff_t n,
                     double* a, double* bounds);
void eliminate_right(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows, std::ptrdiff_t n,
                     std::complex<double>* a, double* bounds);

/// Sizes of n entries; returns the largest.
template <class T>
double sizes(std::ptrdiff_t n, const T* a, double* size) {
  return largest_of(n, [a, size](std::ptrdiff_t j) { return size[j] = size_of(a[j]); });
}
double sizes(std::ptrdiff_t n, const double* a, double* size);
double sizes(std::ptrdiff_t n, const std::complex<double>* a, double* size);

/// The largest of a[j]; none is negative.
double largest(std::ptrdiff_t n, const double* a);
/// The same of a(i, j) b[j], row by row; a is rows x n.
void largest_products(std::ptrdiff_t rows, std::ptrdiff_t n, const double* a, const double* b,
                      double* largest);

}  // namespace titop::solve
