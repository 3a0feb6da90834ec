#pragma once

#include <titop/compiler/passes/close/lines.hpp>

namespace titop::passes::closing {

/// How much of the motions that chains leave, to first order, they do not let go on: at a singular
/// posture (a four-bar linkage folded flat) the equations of first order lose rank, and leave the
/// motions of every way out of it and their sums, of which most lead nowhere.
///
/// Around a closed chain of joints with screws S_i, sum S_i q_i' = 0, and once more differentiated
/// sum S_i q_i'' + sum_(i<j) [S_i, S_j] q_i' q_j' = 0: a motion goes on only if the brackets are in
/// the span of the screws. Random motions of those that are left are tried; the part of their
/// brackets outside the span, over the sum of the brackets' sizes: 0 but for rounding where chains
/// are closed twice and still move (a linkage in a plane), about 1 at a singular posture. 0 where
/// nothing is redundant. -1, not tried: closing equations of fewer than six rows, or through what
/// is prescribed or free as a whole; more than 20 chains that share joints.
/// Source: [Mueller 2002], mobility of higher order. O(rows^2 columns) of the component's matrix:
/// linear in the length of a chain.
///
/// `closings`: those of the component's lines, in this order; `scaled`, by `factors`.
double stopped(const Component& scaled, const Factors& factors,
               const std::vector<const Closing*>& closings, const Graph& graph);

}  // namespace titop::passes::closing
