#pragma once

#include <titop/compiler/solve/factored.hpp>

/// Pivots that are rounding alone. For the compiler's own files only.
namespace titop::detail {

/// Ratio of a pivot to its terms, or reciprocal margin of a loop, at which about half of the digits
/// are lost: below it the result is doubtful.
constexpr double kFewDigits = 1e-7;

/// Whether the joint system is singular, or has no digit left in double, although double has found
/// a pivot everywhere: a pivot is compared with the terms of its own front, and the rounding of an
/// entry that cancelled further down may be taken for one. Decided by a loop's margin, or by 50
/// digits; WeakPivots::least is then the threshold with which the elimination in double detects the
/// singularity. In doubt are a pivot below 1e-7 of its terms, and a loop's margin above 1e8 or
/// without an inverse; a loop of more than kMarginUpTo unknowns is judged by its pivots alone. If
/// the margin leaves no digit (above 2 / 2.2e-16), it decides, so that the result does not depend
/// on the order of elimination. Otherwise one elimination in 50 digits, for scenes of up to 1e7
/// products (some 10,000 scalar bodies, some seconds); beyond, `undecided`. `margins`: one per loop
/// of the stage. O(loops) if nothing is in doubt.
WeakPivots judge_weak_pivots(const Factored& data, std::span<const double> margins);

/// The ports of the loop without a digit, or of the weakest pivot's, as an ill_posed mistake: for
/// dependent rows that double cannot identify.
Mistake no_digit_left(const Factored& data);

}  // namespace titop::detail
