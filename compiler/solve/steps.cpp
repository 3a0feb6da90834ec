#include <cmath>
#include <titop/compiler/solve/steps.hpp>
#include <titop/graph/linalg/wide.hpp>

namespace titop::solve {

TITOP_WIDE void eliminate_below(std::ptrdiff_t k, std::ptrdiff_t end, std::ptrdiff_t rows,
                                std::ptrdiff_t n, double* a, double* bounds) {
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
