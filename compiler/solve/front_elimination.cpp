#include <cmath>
#include <titop/compiler/solve/front_elimination.hpp>
#include <titop/compiler/solve/lanes.hpp>
#include <titop/graph/linalg/wide.hpp>

namespace titop::solve {
namespace {

using Four = Lanes<4>;

/// A row's columns after k up to `end`, in whole registers: zeros come first.
template <int V>
[[gnu::always_inline]] inline void load_behind(const double* row, std::ptrdiff_t k,
                                               std::ptrdiff_t end, Four* to) {
  // Below 0 at a front's beginning, where `behind` does not read.
  const std::ptrdiff_t first = end - 4 * V;
  const auto behind = [&](std::ptrdiff_t j) { return j > k ? row[j] : 0; };
  to[0] = Four{behind(first), behind(first + 1), behind(first + 2), behind(first + 3)};
  for (int v = 1; v < V; ++v) load(to[v], row + first + 4 * v);
}

/// to += factor * from. In the columns before those that count (at the end of the row above where
/// a row has few) 0 is added: they stay as they are, except for the sign of a zero, and for a
/// factor that is not finite; then bounds are not either and the front counts as singular.
template <int V>
[[gnu::always_inline]] inline void add_registers(double factor, const Four* from, double* to) {
  for (int v = 0; v < V; ++v) {
    Four x;
    load(x, to + 4 * v);
    x += factor * from[v];
    store(to + 4 * v, x);
  }
}

/// One step if V registers have all columns: the pivot's row stays in them.
template <int V>
[[gnu::always_inline]] inline void eliminate_narrow(std::ptrdiff_t k, std::ptrdiff_t end,
                                                    std::ptrdiff_t rows, std::ptrdiff_t n,
                                                    double* a, double* bounds) {
  constexpr std::size_t registers = V;
  Four from[registers], bound[registers];
  load_behind<V>(a + k * n, k, end, from);
  load_behind<V>(bounds + k * n, k, end, bound);
  for (int v = 0; v < V; ++v)
    for (int e = 0; e < 4; ++e)
      bound[v][e] = pivot_row_magnitude(std::abs(from[v][e]), bound[v][e]);
  const double pivot = a[k * n + k];
  for (std::ptrdiff_t i = k + 1; i < rows; ++i) {
    double* const row = a + i * n;
    if (row[k] == 0) continue;
    const double l = row[k] / pivot;
    add_registers<V>(-l, from, row + end - 4 * V);
    row[k] = l;
    add_registers<V>(std::abs(l), bound, bounds + i * n + end - 4 * V);
  }
}

}  // namespace

TITOP_WIDE void eliminate_below(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows,
                                std::ptrdiff_t n, double* a, double* bounds) {
  switch ((end - k - 1 + 3) / 4) {
    case 1: return eliminate_narrow<1>(k, end, rows, n, a, bounds);
    case 2: return eliminate_narrow<2>(k, end, rows, n, a, bounds);
    case 3: return eliminate_narrow<3>(k, end, rows, n, a, bounds);
    case 4: return eliminate_narrow<4>(k, end, rows, n, a, bounds);
    case 5: return eliminate_narrow<5>(k, end, rows, n, a, bounds);
    case 6: return eliminate_narrow<6>(k, end, rows, n, a, bounds);
  }
  eliminate_below(k, end, rows, n, a, bounds, [](double x) { return std::abs(x); });
}
TITOP_WIDE void eliminate_below(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows,
                                std::ptrdiff_t n, std::complex<double>* a, double* bounds) {
  eliminate_below(k, end, rows, n, a, bounds, size_of<std::complex<double>>);
}
TITOP_WIDE void eliminate_right(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows,
                                std::ptrdiff_t n, double* a, double* bounds) {
  eliminate_right(k, end, rows, n, a, bounds, [](double x) { return std::abs(x); });
}
TITOP_WIDE void eliminate_right(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows,
                                std::ptrdiff_t n, std::complex<double>* a, double* bounds) {
  eliminate_right(k, end, rows, n, a, bounds, size_of<std::complex<double>>);
}

TITOP_WIDE double sizes(std::ptrdiff_t n, const double* a, double* size) {
  return largest_of(n, [a, size](std::ptrdiff_t j) { return size[j] = std::abs(a[j]); });
}
TITOP_WIDE double sizes(std::ptrdiff_t n, const std::complex<double>* a, double* size) {
  const double* parts = reinterpret_cast<const double*>(a);
  return largest_of(n, [parts, size](std::ptrdiff_t j) {
    return size[j] = std::abs(parts[2 * j]) + std::abs(parts[2 * j + 1]);
  });
}

TITOP_WIDE double largest(std::ptrdiff_t n, const double* a) {
  return largest_of(n, [a](std::ptrdiff_t j) { return a[j]; });
}
TITOP_WIDE void largest_products(std::ptrdiff_t rows, std::ptrdiff_t n, const double* a,
                                 const double* b, double* largest) {
  for (std::ptrdiff_t i = 0; i < rows; ++i, a += n)
    largest[i] = largest_of(n, [a, b](std::ptrdiff_t j) { return a[j] * b[j]; });
}

}  // namespace titop::solve
