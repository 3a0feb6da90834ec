#pragma once

#include <titop/compiler/system_data.hpp>

namespace titop::detail {

/// What a pivot keeps of its terms, or a loop's distance from singular, at which about half of the
/// digits are left: below it there is a doubt.
constexpr double kFewDigits = 1e-7;

/// Whether the joint system is singular, or has no digit left in double, although double has found
/// a pivot everywhere: a pivot is judged by what cancels in its own front, and what has cancelled
/// in an entry further down may stand out as one. A loop's margin says so, or 50 digits. Returns
/// the share of its terms that a pivot has to keep, and below which an entry is 0, for the
/// elimination in double to find it; 0: the factors serve. Asked where the certificate has a doubt:
/// a pivot keeps less than 1e-7, a loop's margin is above 1e8 or was not found, the outputs are
/// right to less than 3 digits, or equations do not hold. Where the margin leaves no digit (above 2
/// / 2.2e-16) that decides, so that no order of elimination does. One elimination in 50 digits
/// then, for scenes of up to 1e7 products (some 10,000 scalar bodies, some seconds); beyond, a note
/// says that it is not decided, and 0.
double least_pivot(const SystemData& d, Check& check);

/// The ports of the loop without a digit, or of the weakest pivot's, as an ill_posed mistake: where
/// double cannot say which rows depend on each other.
Mistake no_digit_left(const Skeleton& k, const SystemData& d);

}  // namespace titop::detail
