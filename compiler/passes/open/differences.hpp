#pragma once

#include <titop/graph/block.hpp>
#include <titop/graph/error.hpp>

namespace titop::passes {

/// Block::opened with these parameters; with `differences` also of a parameter that the block does
/// not open, to first order: w = d z with L z the derivative of its matrices times [x; u], a pair
/// per row that changes. Derivatives are central differences of the block's matrices at three
/// steps, extrapolated [Richardson]: steps of 2^-8, 2^-9 and 2^-10 of the power of two below the
/// value p (of 1 at 0) leave 1e-15 of the seventh derivative times p^7, and 1e-12 of the entry over
/// p by its rounding. A parameter whose derivative is 0, or not known (why_no_differences), has no
/// pairs. Empty if no parameter has any.
std::optional<Opened> opened_to_first_order(const Block& block, ParameterValues values,
                                            std::span<const int> parameters, bool differences);

/// Why opened_to_first_order has no derivative by this parameter, which the block does not open, as
/// a message without the names of both: it moves points of `kinematics`; the block refuses values
/// near the given one; or the last extrapolation changes a row by more than 1e-9 of the row of the
/// derivative and more than rounding of the block's row. Empty if it is known, also if it is 0.
std::optional<Mistake> why_no_differences(const Block& block, ParameterValues values,
                                          int parameter);

/// The parameter moves points of the block's kinematics, and its pairs do not declare it
/// (Opened::motions): positions that are read beyond them would be wrong.
bool moves_points_unsaid(const Block& block, ParameterValues values, int parameter);

/// The block opens this parameter itself.
bool is_opened_by(const Block& block, ParameterValues values, int parameter);

}  // namespace titop::passes
