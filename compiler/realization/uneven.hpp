#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <titop/compiler/realization/writing.hpp>
#include <vector>

namespace titop::detail {

/// Accelerations of modes by unit forces on themselves (the modes have mass 1): dimensionless. Far
/// below 1 for modes constrained by heavy children.
struct OwnTerms {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  void take(double x) { least = std::min(least, x), most = std::max(most, x); }
};

/// An entry that is copied into a row by symmetry has the rounding of its column, which is that of
/// the column's largest entries. Batches (their own terms in turn) with a column smaller than
/// others by more than four digits must be solved again without symmetry. (In an ordinary chain of
/// flexible bodies they differ by three to four: a smaller limit would solve most of it twice.)
std::vector<std::size_t> uneven_batches(const Writing& writing, std::span<const OwnTerms> own);

}  // namespace titop::detail
