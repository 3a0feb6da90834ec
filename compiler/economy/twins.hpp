#pragma once

#include <titop/compiler/economy/coordinates.hpp>

namespace titop::detail {

/// What moves alike because it is built alike.
struct Twins {
  int removed = 0;                 ///< coordinates
  std::vector<std::string> pairs;  ///< "boom1 and boom2", one per symmetry that was used
};

/// Two nodes with the same block, and what hangs on them alike, are candidates: the structure says
/// so, no threshold looks for them. Exchanging them (with a sign per pair of coordinates, and one
/// for every coordinate of the rest) is a symmetry if it leaves M, K, D as they are, entry by
/// entry, to rounding. Where it also leaves all inputs, or all outputs, as they are, motions that
/// change sign under it are not moved, or not seen: the coordinates become common ones, exactly
/// half. Closed chains are left alone. O(n) for each pair of nodes with one block, and O(n^2) where
/// their sizes agree and only signs are to be found.
Twins join_twins(Coordinates& c, const Graph& graph);

}  // namespace titop::detail
