#pragma once

#include <optional>
#include <titop/compiler/solve/joint.hpp>
#include <utility>
#include <vector>

namespace titop::detail {

struct Factored;

/// Conditions for a symmetric matrix from modal forces f to accelerations of all modes, such
/// as the reduced inverse mass of equation (14) of the paper. With y = D u - W' f of all blocks it
/// is symmetric if D is, between the channels' inputs (u) and outputs (y), and if the connections
/// of channels satisfy u' y* = y' u* for any two motions: then W u, the modes' accelerations, is
/// symmetric in f.
struct ReciprocalPairs {
  /// Coefficient `a` is `sign` times coefficient `b` transposed.
  struct Pair {
    int a = -1, b = -1;
    int sign = 1;
  };
  std::vector<Pair> pairs;  ///< of terms between channels
  std::vector<std::pair<int, int>>
      blocks;  ///< node, size: D's first rows and columns are symmetric

  /// To the last bit. O(blocks and terms).
  bool holds(const solve::Numbers& numbers) const;
};

/// The conditions on the values of the parameters; none if terms alone do not decide: other signals
/// than channels act on channels (controllers, gains, sums), directions are driven separately, or a
/// reaction is missing. By structure alone, O(terms log terms).
std::optional<ReciprocalPairs> reciprocity_of(const Factored& data);

}  // namespace titop::detail
