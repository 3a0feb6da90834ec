#pragma once

#include <titop/compiler/certificate/check.hpp>
#include <titop/compiler/solve/factored.hpp>

namespace titop::detail {

/// Ratio of a pivot to its terms, or reciprocal margin of a loop, at which about half of the digits
/// are lost: below it the result is doubtful.
constexpr double kFewDigits = 1e-7;

/// Whether the joint system is singular, or has no digit left in double, although double has found
/// a pivot everywhere: a pivot is compared with the terms of its own front, and the rounding of an
/// entry that cancelled further down may be taken for one. Decided by a loop's margin, or by 50
/// digits. Returns the least ratio of a pivot to its terms, below which an entry is 0, for the
/// elimination in double to detect the singularity; 0: the factors are valid. Called if the
/// certificate is doubtful: a pivot below 1e-7 of its terms, a loop's margin above 1e8 or unknown,
/// outputs with fewer than 3 digits, or equations that are not satisfied. If the margin leaves no
/// digit (above 2 / 2.2e-16), it decides, so that the result does not depend on the order of
/// elimination. Otherwise one elimination in 50 digits, for scenes of up to 1e7 products (some
/// 10,000 scalar bodies, some seconds); beyond, 0 with a note that it is not decided.
double least_pivot(const Factored& d, Check& check);

/// The ports of the loop without a digit, or of the weakest pivot's, as an ill_posed mistake: for
/// dependent rows that double cannot identify.
Mistake no_digit_left(const Skeleton& k, const Factored& d);

}  // namespace titop::detail
