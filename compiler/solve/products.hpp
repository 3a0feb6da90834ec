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

/// The same transposed: y (m x rows) = (a x)', added to y or not, where a stands as its transpose
/// (inner x rows, row-major) and rows and m are multiples of 4.
void multiply_transposed(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m,
                         const double* at, const double* x, double* y, bool add);

/// A column of the dense model: `factor` times column `from` of a solution.
struct Column {
  std::ptrdiff_t from = 0;
  double factor = 1;
  double* state = nullptr;   ///< where it begins in A or B
  double* output = nullptr;  ///< where it begins in C or D
};

/// Rows `row` ... of all these columns, of the states or of the outputs; column `from` of the
/// values begins at from * stride. No -0 is written.
void scatter(std::span<const Column> columns, bool state, std::ptrdiff_t row, std::ptrdiff_t rows,
             const double* values, std::ptrdiff_t stride);

}  // namespace titop::solve
