#pragma once

#include <cstdint>
#include <titop/compiler/solve/elimination.hpp>
#include <vector>

namespace titop::solve {

/// One exponent of two per unknown (Plan::first), the same in all fronts: with it and with factors
/// for the rows the largest entry of every row and of every column of the whole matrix is near 1
/// [Ruiz 2001: square roots of the largest entries, rows and columns at once]. Unknowns of one unit
/// (three of a twist or wrench) share theirs. Within -1000 ... 1000. O(entries of the matrix).
template <class T>
std::vector<std::int16_t> equilibration(const Plan& plan, const Rows<T>& rows);

}  // namespace titop::solve
