#pragma once

#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/solve/instant.hpp>

namespace titop::detail {

/// True if digits may be lost of an input of a block with states, or of an output: Instant::doubt
/// is more than kWarn of `now` there, and more than the rounding of a 0. `signals`: all signals of
/// `now`. One more solution, O(bodies).
bool digits_in_doubt(const Factored& d, const Instant& now, const Signals& signals);

/// Largest ratio of these differences to an output, one column, if it is more than kWarn and more
/// than the rounding of a 0; else 0. O(outputs), O(bodies) if one exceeds it.
double lost_of_outputs(const Factored& d, const solve::RowMatrix<double>& unknowns,
                       const solve::RowMatrix<double>& outputs,
                       const solve::RowMatrix<double>& off);

}  // namespace titop::detail
