#pragma once

#include <cstdint>
#include <span>

namespace titop::solve {

/// Exponents of two that give the columns of a rows x columns matrix of magnitudes (row-major) the
/// same size independent of units: first largest entries brought to 1, rows and columns in turn
/// [Ruiz 2001], then means of binary exponents over the entries [Curtis, Reid 1972]. Entries below
/// 1e-13 after the first step are rounding (a rotation by pi) and excluded from the means, which
/// they would distort. Columns of one unit (three of a twist or wrench) get the same exponent in
/// any orientation of their frame. `units`: the first column of each unit, and the end. Writes one
/// exponent per column, within -1000 ... 1000. O(rows x columns), and scratch of 4 ints per entry
/// if all units are scalars, 2 if all are threes, 6 at most; units per row count up to a multiple
/// of eight.
void column_scale(const double* magnitudes, int rows, std::span<const int> units,
                  std::int16_t* exponents);

}  // namespace titop::solve
