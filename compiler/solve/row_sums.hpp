#pragma once

#include <complex>
#include <cstddef>

/// Sums of rows in registers: the kernel of solutions with the factors and of residuals. The sum
/// runs in order, term by term as by plain loops: the same bits on every processor. `lanes`: as in
/// products.hpp.
namespace titop::solve {

/// y -= l[0] x_0 + l[1] x_1 + ..., `count` rows x_k of m entries each, one after the other; if
/// l[k] is 0, x_k is not read. O(count m).
void subtract_sum(std::ptrdiff_t count, const double* l, const double* x, std::ptrdiff_t m,
                  double* y, int lanes = 8);
void subtract_sum(std::ptrdiff_t count, const std::complex<double>* l,
                  const std::complex<double>* x, std::ptrdiff_t m, std::complex<double>* y,
                  int lanes = 8);

}  // namespace titop::solve
