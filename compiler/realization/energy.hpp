#pragma once

#include <titop/compiler/solve/factored.hpp>

namespace titop::detail {

/// Potential energy x' E x / 2 of the model's states (order x order): of closed chains, whose
/// independent coordinates share springs. Empty if a block does not define its energy. O(n^3).
Eigen::MatrixXd potential_energy(const Factored& data);

}  // namespace titop::detail
