#pragma once

#include <titop/analysis/lft/lft.hpp>

/// Reduction over states and parameters together. For the folder's own files.
namespace titop::detail {

/// A realization with fewer states and pairs.
struct Structured {
  StateSpace m;            ///< its pairs are all called w and z
  std::vector<int> sizes;  ///< pairs of each parameter, in the order of w
  RankMargin margin;
};

/// The pairs of parameter i are `sizes[i]` neighbours in w and z. Least subspaces of the states and
/// of each parameter's pairs that contain B u and all that they cause in one another; the model is
/// restricted to them, transposed, and so on until nothing changes. Blocks of which nothing is
/// dropped keep their coordinates. States count by the invariant subspaces of their poles, which
/// separate before ranks are decided. The result has the same transfer for all deltas, up to the
/// directions dropped. O((states + pairs)^3) per round.
Structured reduced(const StateSpace& m, const std::vector<int>& sizes);

}  // namespace titop::detail
