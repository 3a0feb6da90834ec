#pragma once

#include <optional>
#include <titop/graph/state_space.hpp>

/// Matrices of a linear fractional transformation. For the folder's own files.
namespace titop::detail {

/// Least reciprocal condition number of I - D_zw Delta: its inverse then keeps four digits of the
/// sixteen of double.
inline constexpr double kWellPosed = 1e-12;

/// The model with w = diag(deltas) z, the first entries of its inputs and outputs; none if I - D_zw
/// Delta is singular (reciprocal condition number below kWellPosed). O((states + pairs)^3).
std::optional<StateSpace> closed(const StateSpace& m, const Eigen::VectorXd& deltas);

/// Reciprocal condition number of I - D_zw Delta; 0 if it is singular.
double well_posed(const StateSpace& m, const Eigen::VectorXd& deltas);

}  // namespace titop::detail
