#pragma once

#include <titop/compiler/certify/residual.hpp>
#include <titop/compiler/instant.hpp>

namespace titop::detail {

/// Digits may be lost of what moves a state, or of an output: Instant::doubt is more than kWarn of
/// `now` there, and more than what rounding leaves of a 0. `signals`: all signals of `now`. One
/// more solution, O(bodies).
bool digits_in_doubt(const SystemData& d, const Instant& now, const Signals& signals);

/// Largest share of an output, one column, that these differences are, where it is more than kWarn
/// and more than what rounding leaves of a 0; else 0. O(outputs), O(bodies) where one stands out.
double lost_of_outputs(const SystemData& d, const solve::RowMatrix<double>& unknowns,
                       const solve::RowMatrix<double>& outputs,
                       const solve::RowMatrix<double>& off);

}  // namespace titop::detail
