#pragma once

#include <titop/compiler/solve/joint.hpp>

namespace titop::solve {

/// sign * left * right of a piece for the state space (D and C of the blocks), rows x Piece::size.
Eigen::MatrixXd matrix_of(const Piece& piece, const Numbers& numbers);

/// a b; entries that cancel to rounding (below kCancelled of their terms) are 0.
Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace titop::solve
