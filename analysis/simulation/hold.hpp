#pragma once

#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop {

/// A model at equal steps, exact for inputs that are held over each step (zero-order hold):
/// x(t + h) = A x(t) + B u, with A = exp(A_model h), B = integral of exp(A_model t) B_model over h.
struct Hold {
  Eigen::MatrixXd A;  ///< n x n
  Eigen::MatrixXd B;  ///< n x nu
};

/// By Eigen's exponential of the scaled matrix, each part of A that is coupled with no other by
/// itself: in long double up to 128 states, in double beyond, and rounded once. Entries are off by
/// some 2^k ulp of that precision at 1, 2^k about the largest |pole| h of their part; by up to 4^k
/// if stiff springs connect masses that move slowly together. Throws bad_value unless h is positive
/// and finite, size unless A is n x n and B n x nu. O((n + nu)^3 log(|A| h)) for a part of n
/// states.
Hold hold(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double h);

/// Outputs at t = 0, h, 2 h, ... from x(0) = 0 for inputs held over each step (columns of `inputs`,
/// nu x steps): column k is y at t = k h with u = inputs.col(k). Precision, errors and cost as
/// `hold`, size for inputs of other than nu rows, and O(n^2) per step.
Eigen::MatrixXd held_response(const StateSpace& model, double h, const Eigen::MatrixXd& inputs);

}  // namespace titop
