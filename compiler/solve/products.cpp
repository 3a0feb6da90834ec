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
/// loaded entry of x serves all rows. (By value: a store could alias the product's data.)
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

void product_2(const Product& p, std::ptrdiff_t rows) { product<Lanes<2>, 2>(p, rows); }
void substitution_2(const Substitution& s) { substitution<Lanes<2>>(s); }
#if defined(__x86_64__)
[[gnu::target("avx2")]] void substitution_4(const Substitution& s) { substitution<Lanes<4>>(s); }
[[gnu::target("avx512f")]] void substitution_8(const Substitution& s) { substitution<Lanes<8>>(s); }
[[gnu::target("avx2")]] void product_4(const Product& p, std::ptrdiff_t rows) {
  product<Lanes<4>, 2>(p, rows);
}
[[gnu::target("avx512f")]] void product_8(const Product& p, std::ptrdiff_t rows) {
  product<Lanes<8>, 1>(p, rows);
}
#endif

struct Kernels {
  void (*product)(const Product&, std::ptrdiff_t rows);
  void (*substitution)(const Substitution&);
};

Kernels kernels_here(int at_most) {
#if defined(__x86_64__)
  switch (lanes_here(at_most)) {
    case 8: return {product_8, substitution_8};
    case 4: return {product_4, substitution_4};
  }
#endif
  return {product_2, substitution_2};
}

const Kernels& kernels(int at_most) {
  static const Kernels widest = kernels_here(8), four = kernels_here(4), two = kernels_here(2);
  return at_most >= 8 ? widest : at_most >= 4 ? four : two;
}

}  // namespace

void multiply(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m, const double* a,
              std::ptrdiff_t stride, const double* const* x, const double* const* from, double* y,
              std::ptrdiff_t y_stride, int lanes) {
  kernels(lanes).product({inner, m, a, stride, x, from, y, y_stride}, rows);
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

/// A register of x's entries to both of its columns.
[[gnu::always_inline]] inline void store_both(const Four& entries, const Destination& c,
                                              std::ptrdiff_t i) {
  store(c.first + i, c.by * entries + 0.0);
  if (c.second) store(c.second + i, c.by_second * entries + 0.0);
}

/// Four rows of four columns, to row i on.
[[gnu::always_inline]] inline void scale_tile(const double* x, std::ptrdiff_t stride,
                                              const Destination* to, std::ptrdiff_t i) {
  Four a, b, c, d;
  load(a, x), load(b, x + stride), load(c, x + 2 * stride), load(d, x + 3 * stride);
  const Four ab = __builtin_shufflevector(a, b, 0, 4, 2, 6),
             ba = __builtin_shufflevector(a, b, 1, 5, 3, 7),
             cd = __builtin_shufflevector(c, d, 0, 4, 2, 6),
             dc = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  store_both(__builtin_shufflevector(ab, cd, 0, 1, 4, 5), to[0], i);
  store_both(__builtin_shufflevector(ba, dc, 0, 1, 4, 5), to[1], i);
  store_both(__builtin_shufflevector(ab, cd, 2, 3, 6, 7), to[2], i);
  store_both(__builtin_shufflevector(ba, dc, 2, 3, 6, 7), to[3], i);
}

}  // namespace

/// By tiles; the last ones reach back if rows or columns are no multiple of four.
TITOP_WIDE void scale_transposed(std::ptrdiff_t rows, std::ptrdiff_t columns, const double* x,
                                 std::ptrdiff_t stride, const Destination* to,
                                 std::ptrdiff_t first) {
  constexpr std::ptrdiff_t n = 4;
  if (rows < n || columns < n) {
    for (std::ptrdiff_t j = 0; j < columns; ++j)
      for (std::ptrdiff_t i = 0; i < rows; ++i) {
        const double entry = x[i * stride + j];
        to[j].first[first + i] = to[j].by * entry + 0.0;
        if (to[j].second) to[j].second[first + i] = to[j].by_second * entry + 0.0;
      }
    return;
  }
  for (std::ptrdiff_t j = 0; j < columns; j += n) {
    const std::ptrdiff_t c = std::min(j, columns - n);
    for (std::ptrdiff_t i = 0; i < rows; i += n) {
      const std::ptrdiff_t r = std::min(i, rows - n);
      scale_tile(x + r * stride + c, stride, to + c, first + r);
    }
  }
}

}  // namespace titop::solve
