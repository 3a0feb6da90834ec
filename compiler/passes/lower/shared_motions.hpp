#pragma once

#include <titop/compiler/passes/lower/lowering.hpp>

/// Positions and rates along long chains that several equations read, as in two rows of bodies
/// coupled from body to body by springs. Written out, each of n rows would read up to n states, and
/// the joint system would be dense. Such a motion is a signal of its own: that of the next one up
/// the chain and of the few bodies between.
///
/// It counts against an anchor, the next point up the way at which the chain ends, forks or moves
/// by itself, or at which two ways that one equation reads meet: what cancels in an equation
/// cancels in its coefficients, as it does where motions are written out.
namespace titop::passes {

/// The shared motions of this graph, upper ones first. If several equations read a way of more than
/// a dozen states, these are the motions of the points that they read, and of those at which ways
/// meet. Outputs are no unknowns and do not count. None if no way is that long. O(terms + sum over
/// equations of the length of ways with a common end).
std::vector<Lowering::SharedMotion> find_shared_motions(const Stage& stage, const Graph& graph);

/// Appends the node of a shared motion, whose one signal it is; returns its index.
int add_shared_motion(Graph& graph, const Lowering::SharedMotion& motion);

/// The shared motions that `lower` has added to the stage's graph.
std::vector<Lowering::SharedMotion> shared_motions_of(const Stage& stage);

}  // namespace titop::passes
