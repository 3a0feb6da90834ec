#pragma once

#include <cstddef>

/// The products that the dense model is written with. In all of them the sum over `inner` runs in
/// order, whatever the number of columns: the same bits however the columns are batched, and on
/// every processor. `lanes`: entries of the widest vector register to use (8, 4 or 2); the widest
/// that the processor has below it is taken.
namespace titop::solve {

/// y = from + a x: row i of y (rows x m, row-major) is from[i] plus the sum of a(i, k) x[k], where
/// a is rows x inner, `stride` apart; m is a multiple of 8. Rows of x and `from` stand anywhere;
/// from[i] may be row i of y. No `from`: from 0.
void multiply(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m, const double* a,
              std::ptrdiff_t stride, const double* const* x, const double* const* from, double* y,
              int lanes = 8);

/// The same transposed, from 0: y (m x rows, `y_stride` apart) = (a x)', where a stands as its
/// transpose (inner x rows, row-major, `stride` apart: rows up to a multiple of 4, of which the
/// last ones do not count); m is a multiple of 8.
void multiply_transposed(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m,
                         const double* at, std::ptrdiff_t stride, const double* const* x, double* y,
                         std::ptrdiff_t y_stride, int lanes = 8);

/// y = x': x is rows x columns, y columns x rows, both row-major with these strides.
void transpose(std::ptrdiff_t rows, std::ptrdiff_t columns, const double* x,
               std::ptrdiff_t x_stride, double* y, std::ptrdiff_t y_stride);

/// Row by row, x (rows x m, row-major, m a multiple of 8) loses what the rows above bring with
/// them: L^-1 x where L (rows x pivots, its diagonal 1) stands below the diagonal of lu, rows
/// `stride` apart. Below the pivots that is x' - L' L^-1 x.
void substitute_lower(std::ptrdiff_t rows, std::ptrdiff_t pivots, std::ptrdiff_t m,
                      const double* lu, std::ptrdiff_t stride, double* x, int lanes = 8);

/// x = U^-1 x, U (pivots x pivots) on and above the diagonal of lu.
void substitute_upper(std::ptrdiff_t pivots, std::ptrdiff_t m, const double* lu,
                      std::ptrdiff_t stride, double* x, int lanes = 8);

/// y = factor * x, n entries. No -0 is written.
void scale(std::ptrdiff_t n, double factor, const double* x, double* y);

}  // namespace titop::solve
