#pragma once

#include <titop/graph/state_space.hpp>

namespace titop {

/// 1 for every output and input between which a path through nonzero entries of A, B, C and D
/// leads, else 0; outputs x inputs. O(n^2 inputs).
Eigen::MatrixXd paths(const StateSpace& m);

/// Likewise for every state and column of B; states x columns. O(n^2 columns).
Eigen::MatrixXd paths(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace titop
