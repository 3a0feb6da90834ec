#pragma once

#include <cstddef>

/// The products that write the dense model. In all of them the sum over `inner` runs in order, for
/// any number of columns: the same bits for any batches of columns, and on every processor.
/// `lanes`: entries of the widest vector register to use (8, 4 or 2); the widest available one
/// below it is taken.
namespace titop::solve {

/// y = from + a x: row i of y (rows x m, row-major, `y_stride` apart) is from[i] plus the sum of
/// a(i, k) x[k], where a is rows x inner, `stride` apart; m is a multiple of 8. Rows of x and
/// `from` may be anywhere in memory; from[i] may be row i of y. No `from`: from 0.
void multiply(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m, const double* a,
              std::ptrdiff_t stride, const double* const* x, const double* const* from, double* y,
              std::ptrdiff_t y_stride, int lanes = 8);

/// Forward substitution row by row: x (rows x m, row-major, m a multiple of 8) becomes L^-1 x with
/// L (rows x pivots, its diagonal 1) below the diagonal of lu, rows `stride` apart. Below the
/// pivots that is x' - L' L^-1 x.
void substitute_lower(std::ptrdiff_t rows, std::ptrdiff_t pivots, std::ptrdiff_t m,
                      const double* lu, std::ptrdiff_t stride, double* x, int lanes = 8);

/// x = U^-1 x, U (pivots x pivots) on and above the diagonal of lu.
void substitute_upper(std::ptrdiff_t pivots, std::ptrdiff_t m, const double* lu,
                      std::ptrdiff_t stride, double* x, int lanes = 8);

/// Destination of multiples of a column x: first = by * x, and second = by_second * x if there is
/// one. No -0 is written.
struct Destination {
  double* first = nullptr;
  double by = 1;
  double* second = nullptr;
  double by_second = 0;
};

/// Writes multiples of the columns of x (rows x columns, row-major, `stride` apart) to the rows of
/// `to` from `first` on, in the order of x.
void scale_transposed(std::ptrdiff_t rows, std::ptrdiff_t columns, const double* x,
                      std::ptrdiff_t stride, const Destination* to, std::ptrdiff_t first);

}  // namespace titop::solve
