#pragma once

#include <titop/compiler/solve/factored.hpp>

/// Pivots that are rounding alone. For the compiler's own files only.
namespace titop::detail {

/// Ratio of a pivot to its terms, or reciprocal margin of a loop, at which about half of the digits
/// are lost: below it the result is doubtful.
constexpr double kFewDigits = 1e-7;

/// Whether the joint system is singular, or has no digit left in double, although double has found
/// a pivot everywhere: a pivot is compared with the terms of its own front, and the rounding of an
/// entry that cancelled further down may be taken for one. WeakPivots::least is then the threshold
/// with which the elimination in double detects the singularity. In doubt are a pivot below 1e-7
/// of its terms, a loop's margin above 1e8 or without an inverse, and a loop of more than
/// kMarginUpTo unknowns of which a known solution is not found to three digits. If the margin
/// leaves no digit (above 2 / 2.2e-16), it decides, so that the result does not depend on the order
/// of elimination. Otherwise the refinement of the known solution (known_solution.hpp). `margins`:
/// one per loop of the stage. O(loops) if nothing is in doubt; one solution with the factors if
/// there are loops of more than kMarginUpTo unknowns.
WeakPivots judge_weak_pivots(const Factored& data, std::span<const double> margins);

/// The ports of the loop without a digit, or of the weakest pivot's, as an ill_posed mistake: for
/// dependent rows that double cannot identify.
Mistake no_digit_left(const Factored& data);

}  // namespace titop::detail
