#include <algorithm>
#include <titop/compiler/solve/lanes.hpp>
#include <titop/compiler/solve/products.hpp>
#include <titop/graph/linalg/wide.hpp>

namespace titop::solve {
namespace {

struct Product {
  std::ptrdiff_t inner, m;
  const double* a;
  std::ptrdiff_t stride;
  const double* const* x;
  const double* const* from;  ///< of rows; none: from 0
  double* y;
  std::ptrdiff_t y_stride;
};

struct Substitution {
  bool upper;
  std::ptrdiff_t rows, pivots, m;
  const double* lu;
  std::ptrdiff_t stride;
  double* x;
};

/// R rows from row i on, C registers of columns at a time: their sums stay in registers, and every
/// entry of x that is loaded serves all rows. (By value: what is stored could be the product's.)
template <class L, int C, int R>
[[gnu::always_inline]] inline void rows_of_product(const Product p, std::ptrdiff_t i) {
  constexpr std::ptrdiff_t n = kLanes<L>;
  constexpr std::size_t width = C, height = R;
  const double* const a = p.a + i * p.stride;
  double* const y = p.y + i * p.y_stride;
  for (std::ptrdiff_t j = 0; j < p.m; j += C * n) {
    L sum[height][width] = {};
    if (p.from)
      for (int r = 0; r < R; ++r)
        for (int c = 0; c < C; ++c) load(sum[r][c], p.from[i + r] + j + c * n);
    for (std::ptrdiff_t k = 0; k < p.inner; ++k) {
      L x[width];
      for (int c = 0; c < C; ++c) load(x[c], p.x[k] + j + c * n);
      for (int r = 0; r < R; ++r)
        for (int c = 0; c < C; ++c) sum[r][c] += a[r * p.stride + k] * x[c];
    }
    for (int r = 0; r < R; ++r)
      for (int c = 0; c < C; ++c) store(y + r * p.y_stride + j + c * n, sum[r][c]);
  }
}

/// The first `count` entries of a register, at most three. (A place that is not a constant would
/// take the register through memory.)
template <class L>
[[gnu::always_inline]] inline void store_first(double* to, const L& from, std::ptrdiff_t count) {
  if constexpr (kLanes<L> >= 4) {
    if (count >= 2) store(to, Lanes<2>{from[0], from[1]});
    if (count == 3) to[2] = from[2];
  }
  if (count == 1) to[0] = from[0];
}

/// `count` rows from row i on, at most as many as L has entries; eight columns from j on.
template <class L>
[[gnu::always_inline]] inline void transposed_tile(const Product p, std::ptrdiff_t i,
                                                   std::ptrdiff_t j, std::ptrdiff_t count) {
  constexpr int C = 8;
  L sum[C] = {};
  for (std::ptrdiff_t k = 0; k < p.inner; ++k) {
    L a;
    load(a, p.a + k * p.stride + i);
    const double* const x = p.x[k] + j;
    for (int c = 0; c < C; ++c) sum[c] += a * x[c];
  }
  double* const y = p.y + j * p.y_stride + i;
  if (count >= kLanes<L>)
    for (int c = 0; c < C; ++c) store(y + c * p.y_stride, sum[c]);
  else
    for (int c = 0; c < C; ++c) store_first(y + c * p.y_stride, sum[c], count);
}

/// One row of a substitution, a register of columns from j on: sums stay there.
template <class L>
[[gnu::always_inline]] inline void substitute_row(const Substitution& s, std::ptrdiff_t r,
                                                  std::ptrdiff_t from, std::ptrdiff_t to,
                                                  std::ptrdiff_t j, bool divide) {
  const double* const a = s.lu + r * s.stride;
  double* const x = s.x + j;
  L sum;
  load(sum, x + r * s.m);
  for (std::ptrdiff_t k = from; k < to; ++k) {
    L row;
    load(row, x + k * s.m);
    sum -= a[k] * row;
  }
  if (divide) sum /= a[r];
  store(x + r * s.m, sum);
}

template <class L>
[[gnu::always_inline]] inline void substitution(const Substitution& s) {
  constexpr std::ptrdiff_t n = kLanes<L>;
  if (s.upper)
    for (std::ptrdiff_t r = s.pivots - 1; r >= 0; --r)
      for (std::ptrdiff_t j = 0; j < s.m; j += n) substitute_row<L>(s, r, r + 1, s.pivots, j, true);
  else
    for (std::ptrdiff_t r = 1; r < s.rows; ++r)
      for (std::ptrdiff_t j = 0; j < s.m; j += n)
        substitute_row<L>(s, r, 0, r < s.pivots ? r : s.pivots, j, false);
}

template <class L, int C>
[[gnu::always_inline]] inline void product(const Product& p, std::ptrdiff_t rows) {
  std::ptrdiff_t i = 0;
  for (; i + 6 <= rows; i += 6) rows_of_product<L, C, 6>(p, i);
  for (; i + 2 <= rows; i += 2) rows_of_product<L, C, 2>(p, i);
  for (; i < rows; ++i) rows_of_product<L, C, 1>(p, i);
}

/// `Rest`: for the last four rows, where L is longer.
template <class L, class Rest>
[[gnu::always_inline]] inline void transposed(const Product& p, std::ptrdiff_t rows) {
  constexpr std::ptrdiff_t n = kLanes<L>, rest = kLanes<Rest>;
  for (std::ptrdiff_t j = 0; j < p.m; j += 8) {
    std::ptrdiff_t i = 0;
    for (; i + n <= rows; i += n) transposed_tile<L>(p, i, j, n);
    for (; i < rows; i += rest) transposed_tile<Rest>(p, i, j, rows - i);
  }
}

void product_2(const Product& p, std::ptrdiff_t rows) { product<Lanes<2>, 2>(p, rows); }
void transposed_2(const Product& p, std::ptrdiff_t rows) {
  transposed<Lanes<2>, Lanes<2>>(p, rows);
}
void substitution_2(const Substitution& s) { substitution<Lanes<2>>(s); }
#if defined(__x86_64__)
[[gnu::target("avx2")]] void substitution_4(const Substitution& s) { substitution<Lanes<4>>(s); }
[[gnu::target("avx512f")]] void substitution_8(const Substitution& s) { substitution<Lanes<8>>(s); }
[[gnu::target("avx2")]] void product_4(const Product& p, std::ptrdiff_t rows) {
  product<Lanes<4>, 2>(p, rows);
}
[[gnu::target("avx2")]] void transposed_4(const Product& p, std::ptrdiff_t rows) {
  transposed<Lanes<4>, Lanes<4>>(p, rows);
}
[[gnu::target("avx512f")]] void product_8(const Product& p, std::ptrdiff_t rows) {
  product<Lanes<8>, 1>(p, rows);
}
[[gnu::target("avx512f")]] void transposed_8(const Product& p, std::ptrdiff_t rows) {
  transposed<Lanes<8>, Lanes<4>>(p, rows);
}
#endif

struct Kernels {
  void (*product)(const Product&, std::ptrdiff_t rows);
  void (*transposed)(const Product&, std::ptrdiff_t rows);
  void (*substitution)(const Substitution&);
};

Kernels kernels_here(int at_most) {
#if defined(__x86_64__)
  switch (lanes_here(at_most)) {
    case 8: return {product_8, transposed_8, substitution_8};
    case 4: return {product_4, transposed_4, substitution_4};
  }
#endif
  return {product_2, transposed_2, substitution_2};
}

const Kernels& kernels(int at_most) {
  static const Kernels widest = kernels_here(8), four = kernels_here(4), two = kernels_here(2);
  return at_most >= 8 ? widest : at_most >= 4 ? four : two;
}

}  // namespace

void multiply(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m, const double* a,
              std::ptrdiff_t stride, const double* const* x, const double* const* from, double* y,
              int lanes) {
  kernels(lanes).product({inner, m, a, stride, x, from, y, m}, rows);
}

void multiply_transposed(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m,
                         const double* at, std::ptrdiff_t stride, const double* const* x, double* y,
                         std::ptrdiff_t y_stride, int lanes) {
  kernels(lanes).transposed({inner, m, at, stride, x, nullptr, y, y_stride}, rows);
}

void substitute_lower(std::ptrdiff_t rows, std::ptrdiff_t pivots, std::ptrdiff_t m,
                      const double* lu, std::ptrdiff_t stride, double* x, int lanes) {
  kernels(lanes).substitution({false, rows, pivots, m, lu, stride, x});
}

void substitute_upper(std::ptrdiff_t pivots, std::ptrdiff_t m, const double* lu,
                      std::ptrdiff_t stride, double* x, int lanes) {
  kernels(lanes).substitution({true, pivots, pivots, m, lu, stride, x});
}

namespace {

using Four = Lanes<4>;

/// Four rows of four columns.
[[gnu::always_inline]] inline void transpose_tile(const double* x, std::ptrdiff_t x_stride,
                                                  double* y, std::ptrdiff_t y_stride) {
  Four a, b, c, d;
  load(a, x), load(b, x + x_stride), load(c, x + 2 * x_stride), load(d, x + 3 * x_stride);
  const Four ab = __builtin_shufflevector(a, b, 0, 4, 2, 6),
             ba = __builtin_shufflevector(a, b, 1, 5, 3, 7),
             cd = __builtin_shufflevector(c, d, 0, 4, 2, 6),
             dc = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  const Four first = __builtin_shufflevector(ab, cd, 0, 1, 4, 5),
             second = __builtin_shufflevector(ba, dc, 0, 1, 4, 5),
             third = __builtin_shufflevector(ab, cd, 2, 3, 6, 7),
             fourth = __builtin_shufflevector(ba, dc, 2, 3, 6, 7);
  store(y, first), store(y + y_stride, second), store(y + 2 * y_stride, third),
      store(y + 3 * y_stride, fourth);
}

}  // namespace

/// By tiles; the last ones reach back where rows or columns are no multiple of four.
TITOP_WIDE void transpose(std::ptrdiff_t rows, std::ptrdiff_t columns, const double* x,
                          std::ptrdiff_t x_stride, double* y, std::ptrdiff_t y_stride) {
  constexpr std::ptrdiff_t n = 4;
  if (rows < n || columns < n) {
    for (std::ptrdiff_t i = 0; i < rows; ++i)
      for (std::ptrdiff_t j = 0; j < columns; ++j) y[j * y_stride + i] = x[i * x_stride + j];
    return;
  }
  for (std::ptrdiff_t i = 0; i < rows; i += n)
    for (std::ptrdiff_t j = 0; j < columns; j += n) {
      const std::ptrdiff_t r = std::min(i, rows - n), c = std::min(j, columns - n);
      transpose_tile(x + r * x_stride + c, x_stride, y + c * y_stride + r, y_stride);
    }
}

TITOP_WIDE void scale(std::ptrdiff_t n, double factor, const double* x, double* y) {
  for (std::ptrdiff_t i = 0; i < n; ++i) y[i] = factor * x[i] + 0.0;
}

}  // namespace titop::solve
