#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <titop/compiler/dense/writing.hpp>
#include <vector>

namespace titop::detail {

/// How much modes are accelerated by forces of their own, of mass 1 as they are: a number without
/// unit. Far below 1 for those that heavy children hold.
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
