#pragma once

#include <titop/compiler/loops/lines.hpp>

namespace titop::loops {

/// Fraction of the chains' first-order mobility that is blocked at second order: at a singular
/// posture (a four-bar linkage folded flat) the equations of first order lose rank, and allow the
/// motions of every branch and their sums, most of which cannot continue.
///
/// Around a closed chain of joints with screws S_i, sum S_i q_i' = 0, and once more differentiated
/// sum S_i q_i'' + sum_(i<j) [S_i, S_j] q_i' q_j' = 0: a motion can continue only if the brackets
/// are in the span of the screws. Random motions of the first-order mobility are tried; the result
/// is the part of their brackets outside the span, over the sum of the brackets' sizes: rounding
/// for over-constrained chains that still move (a linkage in a plane), about 1 at a singular
/// posture. 0 if nothing is redundant. -1, not tried: closing equations of fewer than six rows, or
/// through prescribed or entirely free motions; more than 20 chains that share joints. O(rows^2
/// columns) of the component's matrix: linear in the length of a chain.
///
/// `closings`: those of the component's lines, in this order; `scaled`, by `factors`.
double stopped(const Component& scaled, const ScaleFactors& factors,
               const std::vector<const Closing*>& closings, const Graph& graph);

}  // namespace titop::loops
