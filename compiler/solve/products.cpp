#include <cstring>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/products.hpp>

namespace titop::solve {
namespace {

/// Four entries in one register.
using Lane = double __attribute__((vector_size(32)));

/// Eight entries: one, two or four registers.
using Lanes = double __attribute__((vector_size(64)));

/// Wherever it stands. (By reference: a vector returned by value has another ABI without AVX.)
template <class L>
[[gnu::always_inline]] inline void load(L& to, const double* from) {
  std::memcpy(&to, from, sizeof to);
}
template <class L>
[[gnu::always_inline]] inline void store(double* to, const L& from) {
  std::memcpy(to, &from, sizeof from);
}

struct Product {
  std::ptrdiff_t inner, m;
  const double* a;
  std::ptrdiff_t stride;
  const double* x;
  double* y;
  std::ptrdiff_t y_stride;
  bool add;
};

/// R rows from row i on, eight columns at a time: their sums stay in registers, and every entry of
/// x that is loaded serves all rows.
template <int R>
[[gnu::always_inline]] inline void rows_of_product(const Product& p, std::ptrdiff_t i) {
  for (std::ptrdiff_t j = 0; j < p.m; j += 8) {
    double* const y = p.y + i * p.y_stride + j;
    Lanes sum[R];
    for (int r = 0; r < R; ++r) {
      sum[r] = Lanes{};
      if (p.add) load(sum[r], y + r * p.y_stride);
    }
    for (std::ptrdiff_t k = 0; k < p.inner; ++k) {
      Lanes x;
      load(x, p.x + k * p.m + j);
      for (int r = 0; r < R; ++r) sum[r] += p.a[(i + r) * p.stride + k] * x;
    }
    for (int r = 0; r < R; ++r) store(y + r * p.y_stride, sum[r]);
  }
}

/// As many rows as L has entries, from row i on; C columns from j on.
template <class L, int C>
[[gnu::always_inline]] inline void transposed_tile(const Product& p, std::ptrdiff_t i,
                                                   std::ptrdiff_t j) {
  double* const y = p.y + j * p.y_stride + i;
  L sum[C];
  for (int c = 0; c < C; ++c) {
    sum[c] = L{};
    if (p.add) load(sum[c], y + c * p.y_stride);
  }
  for (std::ptrdiff_t k = 0; k < p.inner; ++k) {
    L a;
    load(a, p.a + k * p.stride + i);
    for (int c = 0; c < C; ++c) sum[c] += a * p.x[k * p.m + j + c];
  }
  for (int c = 0; c < C; ++c) store(y + c * p.y_stride, sum[c]);
}

}  // namespace

TITOP_WIDE void multiply(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m,
                         const double* a, std::ptrdiff_t stride, const double* x, double* y,
                         bool add) {
  const Product p{inner, m, a, stride, x, y, m, add};
  std::ptrdiff_t i = 0;
  for (; i + 6 <= rows; i += 6) rows_of_product<6>(p, i);
  for (; i + 2 <= rows; i += 2) rows_of_product<2>(p, i);
  for (; i < rows; ++i) rows_of_product<1>(p, i);
}

TITOP_WIDE void multiply_transposed(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m,
                                    const double* at, const double* x, double* y,
                                    std::ptrdiff_t y_stride, bool add) {
  const Product p{inner, m, at, rows, x, y, y_stride, add};
  for (std::ptrdiff_t j = 0; j < m; j += 8) {
    std::ptrdiff_t i = 0;
    for (; i + 8 <= rows; i += 8) transposed_tile<Lanes, 8>(p, i, j);
    for (; i < rows; i += 4) transposed_tile<Lane, 8>(p, i, j);
  }
}

TITOP_WIDE void write_runs(std::span<const Run> runs, double factor, const double* values,
                           double* column) {
  for (const Run& run : runs) {
    double* const to = column + run.to;
    if (run.from < 0) {
      for (std::ptrdiff_t i = 0; i < run.count; ++i) to[i] = 0;
      continue;
    }
    const double* const from = values + run.from;
    for (std::ptrdiff_t i = 0; i < run.count; ++i) to[i] = factor * from[i] + 0.0;
  }
}

}  // namespace titop::solve
