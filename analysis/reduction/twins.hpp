#pragma once

#include <titop/analysis/reduction/coordinates.hpp>

namespace titop::detail {

/// Result of the reduction by symmetry of equal bodies.
struct TwinReduction {
  int removed = 0;                 ///< coordinates
  std::vector<std::string> pairs;  ///< "boom1 and boom2", one per symmetry that was used
};

/// Two nodes with the same block and equal neighbours are candidates, by structure alone, without
/// thresholds. Exchanging them (with a sign per pair of coordinates, and one for every coordinate
/// of the rest) is a symmetry if it preserves M, K, D, entry by entry, to rounding. If it also
/// preserves all inputs, or all outputs, motions that change sign under it are unreachable, or
/// unobservable: the coordinates are replaced by their common ones, exactly half. Closed chains are
/// not reduced. O(n) for each pair of nodes with one block, and O(n^2) if their sizes agree and
/// only signs are unknown.
TwinReduction join_twins(Coordinates& c, const Graph& graph);

}  // namespace titop::detail
