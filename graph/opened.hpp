#pragma once

#include <titop/graph/block.hpp>

/// Assembly of `Block::opened`: pairs of parameters added to the matrices of a block.
namespace titop {

/// One pair (w, z) of a parameter. Empty vectors are 0.
///
///     z = of_states x + of_inputs u + of_outputs y + (coefficients * w of other pairs)
///     xdot += on_states w,   y += on_outputs w
struct OpenedPair {
  Value value;                                                ///< w counts value.scale() times
  Eigen::VectorXd on_states, on_outputs;                      ///< where w acts
  Eigen::RowVectorXd of_states, of_inputs;                    ///< x and u of the block
  Eigen::RowVectorXd of_outputs = {};                         ///< y, with the effect of all w
  std::vector<std::pair<std::size_t, double>> of_pairs = {};  ///< w of pairs of the list, by index
  int moves = -1;                     ///< channel whose position w moves, -1: none (OpenedMotion)
  Eigen::VectorXd moved_by = {};      ///< OpenedMotion::by
  Eigen::RowVectorXd of_motion = {};  ///< OpenedMotion::of
  Eigen::RowVectorXd of_motion_states = {};  ///< OpenedMotion::of_states
  /// value.scale() multiplies z, and not w: where the products with `on_...` would be rounded, and
  /// several pairs that act alike would no longer be found to be one. Not for pairs that move.
  bool scale_z = false;
};

/// True if this value is one of these parameters, or a multiple of one.
bool is_opened(const Value& value, std::span<const int> parameters);

/// The matrices with all pairs whose value is one of `parameters`, in the order of the list. The
/// other pairs are omitted: their w is 0. O(entries).
Opened with_pairs(const Dynamics& dynamics, const std::vector<OpenedPair>& pairs,
                  std::span<const int> parameters);

}  // namespace titop
