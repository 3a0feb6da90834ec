#pragma once

#include <titop/graph/block.hpp>

namespace titop::passes {

/// Block::opened with these parameters; with `differences` also of a parameter that the block does
/// not open, to first order: w = d z with L z the derivative of its matrices times [x; u], a pair
/// per row that changes. Derivatives are central differences of the block's matrices at three
/// steps, extrapolated [Richardson]: steps of 2^-8, 2^-9 and 2^-10 of the value (of 1 at 0) leave
/// 1e-15 of the seventh derivative, and their rounding 1e-12. A parameter that moves points of
/// `kinematics`, or near which the block refuses values, has no pairs then. Empty if no parameter
/// has any.
std::optional<Opened> opened_to_first_order(const Block& block, ParameterValues values,
                                            std::span<const int> parameters, bool differences);

/// The parameter moves points of the block's kinematics, and its pairs do not say so
/// (Opened::motions): positions that are read beyond them would be wrong.
bool moves_points_unsaid(const Block& block, ParameterValues values, int parameter);

/// The block opens this parameter itself.
bool is_opened_by(const Block& block, ParameterValues values, int parameter);

}  // namespace titop::passes
