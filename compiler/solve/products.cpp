#include <cstring>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/products.hpp>

namespace titop::solve {
namespace {

/// Four entries in one register.
using Lane = double __attribute__((vector_size(32)));

/// Wherever it stands. (By reference: a vector returned by value has another ABI without AVX.)
[[gnu::always_inline]] inline void load(Lane& to, const double* from) {
  std::memcpy(&to, from, sizeof to);
}
[[gnu::always_inline]] inline void store(double* to, const Lane& from) {
  std::memcpy(to, &from, sizeof from);
}

struct Product {
  std::ptrdiff_t inner, m;
  const double* a;
  std::ptrdiff_t stride;
  const double* x;
  double* y;
  bool add;
};

/// R rows from row i on, eight columns at a time: their sums stay in registers, and every entry of
/// x that is loaded serves all rows.
template <int R>
[[gnu::always_inline]] inline void rows_of_product(const Product& p, std::ptrdiff_t i) {
  for (std::ptrdiff_t j = 0; j < p.m; j += 8) {
    double* const y = p.y + i * p.m + j;
    Lane left[R], right[R];
    for (int r = 0; r < R; ++r) {
      left[r] = right[r] = Lane{};
      if (p.add) load(left[r], y + r * p.m), load(right[r], y + r * p.m + 4);
    }
    for (std::ptrdiff_t k = 0; k < p.inner; ++k) {
      Lane x, z;
      load(x, p.x + k * p.m + j);
      load(z, p.x + k * p.m + j + 4);
      for (int r = 0; r < R; ++r) {
        const double a = p.a[(i + r) * p.stride + k];
        left[r] += a * x;
        right[r] += a * z;
      }
    }
    for (int r = 0; r < R; ++r) {
      store(y + r * p.m, left[r]);
      store(y + r * p.m + 4, right[r]);
    }
  }
}

/// R times four rows from row i on, C columns from j on.
template <int R, int C>
[[gnu::always_inline]] inline void transposed_tile(const Product& p, std::ptrdiff_t i,
                                                   std::ptrdiff_t j) {
  double* const y = p.y + j * p.stride + i;
  Lane sum[C][R];
  for (int c = 0; c < C; ++c)
    for (int r = 0; r < R; ++r) {
      sum[c][r] = Lane{};
      if (p.add) load(sum[c][r], y + c * p.stride + 4 * r);
    }
  for (std::ptrdiff_t k = 0; k < p.inner; ++k) {
    Lane a[R];
    for (int r = 0; r < R; ++r) load(a[r], p.a + k * p.stride + i + 4 * r);
    for (int c = 0; c < C; ++c) {
      const double x = p.x[k * p.m + j + c];
      for (int r = 0; r < R; ++r) sum[c][r] += a[r] * x;
    }
  }
  for (int c = 0; c < C; ++c)
    for (int r = 0; r < R; ++r) store(y + c * p.stride + 4 * r, sum[c][r]);
}

}  // namespace

TITOP_WIDE void multiply(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m,
                         const double* a, std::ptrdiff_t stride, const double* x, double* y,
                         bool add) {
  const Product p{inner, m, a, stride, x, y, add};
  std::ptrdiff_t i = 0;
  for (; i + 6 <= rows; i += 6) rows_of_product<6>(p, i);
  for (; i + 2 <= rows; i += 2) rows_of_product<2>(p, i);
  for (; i < rows; ++i) rows_of_product<1>(p, i);
}

TITOP_WIDE void multiply_transposed(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m,
                                    const double* at, const double* x, double* y, bool add) {
  const Product p{inner, m, at, rows, x, y, add};
  for (std::ptrdiff_t j = 0; j < m; j += 4) {
    std::ptrdiff_t i = 0;
    for (; i + 8 <= rows; i += 8) transposed_tile<2, 4>(p, i, j);
    for (; i < rows; i += 4) transposed_tile<1, 4>(p, i, j);
  }
}

TITOP_WIDE void scatter(std::span<const Column> columns, bool state, std::ptrdiff_t row,
                        std::ptrdiff_t rows, const double* values, std::ptrdiff_t stride) {
  for (const Column& c : columns) {
    const double* const from = values + c.from * stride;
    double* const to = (state ? c.state : c.output) + row;
    std::ptrdiff_t i = 0;
    for (; i + 4 <= rows; i += 4) {
      Lane v;
      load(v, from + i);
      store(to + i, c.factor * v + Lane{});
    }
    for (; i < rows; ++i) to[i] = c.factor * from[i] + 0.0;
  }
}

}  // namespace titop::solve
