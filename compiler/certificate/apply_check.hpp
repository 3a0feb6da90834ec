#pragma once

#include <string>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/factored.hpp>

namespace titop::detail {

/// See Certificate::apply_against_transfer.
struct ApplyDifference {
  double worst = 0;
  /// A state that follows from others but has a rate of its own: an equation prescribes a motion
  /// that a closed chain prevents. "" if there is none.
  std::string prevented;
};

/// `point`: at s, driven by u, one column. `lost`: share of the outputs that double loses there; a
/// difference of up to 32 times as much counts as 0. O(bodies): two solutions, three more if the
/// difference is above rounding.
ApplyDifference apply_difference(const Factored& data, const Evaluation<double>& point,
                                 const solve::RowMatrix<double>& u, double s, double lost);

}  // namespace titop::detail
