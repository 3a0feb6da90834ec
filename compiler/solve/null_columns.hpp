#pragma once

#include <titop/compiler/solve/null_rows.hpp>

namespace titop::solve {

/// Columns z (unknowns x k, in the order of Plan::first) with L z = 0, k the rank that L lacks: the
/// counterpart of `null_rows` for the same factors. Every z has 1 in an unknown of its own, where
/// the other ones have 0. Entries that cancel are exactly 0; `size` says what the others were made
/// of, for sums of them. O(fronts) per pair of patches.
KeptMatrix null_columns(const Factors<double>& patched);

}  // namespace titop::solve
