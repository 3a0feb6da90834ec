#pragma once

#include <cstddef>
#include <span>

/// The products that the dense model is written with. In all of them the sum over `inner` runs in
/// order, whatever the number of columns: the same bits however the columns are batched.
namespace titop::solve {

/// y (rows x m) = a (rows x inner, `stride` apart) * x (inner x m), added to y or not, all
/// row-major; m is a multiple of 8.
void multiply(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m, const double* a,
              std::ptrdiff_t stride, const double* x, double* y, bool add);

/// The same transposed: y (m x rows, `y_stride` apart) = (a x)', added to y or not, where a stands
/// as its transpose (inner x rows, row-major); rows is a multiple of 4, m of 8.
void multiply_transposed(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m,
                         const double* at, const double* x, double* y, std::ptrdiff_t y_stride,
                         bool add);

/// Where some values of a column go.
struct Run {
  std::ptrdiff_t from = -1;  ///< their place among the values; -1: zeros
  std::ptrdiff_t to = 0, count = 0;
};

/// Writes factor * values to a column, run by run. No -0 is written.
void write_runs(std::span<const Run> runs, double factor, const double* values, double* column);

}  // namespace titop::solve
