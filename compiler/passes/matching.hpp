#pragma once

#include <titop/compiler/passes/incidence.hpp>

namespace titop::passes {

/// Matching of row vertices and column vertices; -1 for none.
struct Matching {
  std::vector<int> row_to_col, col_to_row;
  int missing() const;  ///< rows and columns without a partner
};

/// Maximum bipartite matching between rows and columns of the same size, from each channel's
/// default. O(entries) if the defaults suffice, else O(entries) per remaining row.
Matching maximum_matching(const Graph& graph, const Incidence& incidence);

/// The mistakes of a graph without a perfect matching, in ports: per independent part the surplus
/// equations, the undetermined signals (Dulmage-Mendelsohn), and the channels whose other side may
/// be driven instead, each of them tried. O(entries) per channel.
std::vector<Mistake> structure_mistakes(const Graph& graph, const Incidence& incidence,
                                        const Matching& matching);

}  // namespace titop::passes
