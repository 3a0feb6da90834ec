#pragma once

#include <titop/compiler/index_reduction/hidden.hpp>

namespace titop::detail {

/// Effects of the derivatives of inputs.
struct InputDerivatives {
  /// by_input[j]: contribution of u^(j) to the blocks' dependent states, blocks' states x inputs.
  std::vector<Eigen::MatrixXd> by_input;
  /// forcing[j]: contribution of u^(j + 1) to the rows of the joint system, rows x inputs.
  std::vector<solve::RowMatrix<double>> forcing;
  std::vector<Hidden> constraints;  ///< all, in the order in which they were met
};

/// Shifts the states of the model by multiples of inputs and their derivatives so that only inputs
/// themselves remain in it (StateMap::set_inputs, noted). Throws improper if a derivative still
/// reaches an output, by more than the rounding of a 0: its share of the output at some s does not
/// matter. O(bodies) per input and derivative.
void make_proper(Skeleton& k, Factored& d, const InputDerivatives& derivatives);

}  // namespace titop::detail
