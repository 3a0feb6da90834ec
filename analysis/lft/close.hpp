#pragma once

#include <optional>
#include <titop/graph/state_space.hpp>

/// Matrices of a linear fractional transformation. For the folder's own files.
namespace titop::detail {

/// Least margin (well_posed) of I - D_zw Delta: its inverse then keeps four digits of the sixteen
/// of double.
inline constexpr double kWellPosed = 1e-12;

/// The model with w = diag(deltas) z, the first entries of its inputs and outputs; none if I - D_zw
/// Delta is singular (margin up to kWellPosed). O((states + pairs)^3).
std::optional<StateSpace> closed(const StateSpace& m, const Eigen::VectorXd& deltas);

/// Relative distance of I - D_zw Delta from singular, 1 / (|(I - D_zw Delta)^-1| (1 + |D_zw
/// Delta|)) in norms of sums of columns, with w and z scaled: 0 if it is singular, and negative
/// where its determinant is, so that it is singular somewhere on the way from Delta = 0.
/// O(pairs^3).
double well_posed(const StateSpace& m, const Eigen::VectorXd& deltas);

}  // namespace titop::detail
