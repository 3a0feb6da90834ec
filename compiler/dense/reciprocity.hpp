#pragma once

#include <optional>
#include <titop/compiler/solve/joint.hpp>
#include <utility>
#include <vector>

namespace titop::detail {

struct SystemData;

/// Whether the accelerations of all modes answer the modal forces f by a symmetric matrix, as the
/// reduced inverse mass of equation (14) of the paper is one. With y = D u - W' f of all blocks it
/// is symmetric if D is, between what channels take (u) and give (y), and if what connects channels
/// lets u' y* = y' u* for any two motions: then W u, what the modes feel, is symmetric in f.
struct Reciprocity {
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

/// What these values of the parameters have to fulfil; none where it takes more than looking at
/// terms: something else than channels acts on channels (controllers, gains, sums), directions are
/// driven apart, or nothing acts back. By structure alone, O(terms log terms).
std::optional<Reciprocity> reciprocity_of(const SystemData& data);

}  // namespace titop::detail
