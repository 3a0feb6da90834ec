#pragma once

#include <string>
#include <titop/graph/graph.hpp>

namespace titop::certification {

/// Reason why a diagram as written is no structure; empty if it is one: bodies, joints, and forces
/// by positions and rates that are those of springs and dampers
/// (compiler/passes/check/springs.hpp); no other gain between motions and forces, no force by a
/// one-way block; and connections that do no work, so that a point that moves with another returns
/// its wrench there. The last by random motions and wrenches that fit the connections and must do
/// no work together (Tellegen's theorem). Parts that only read do not count. O(terms), times the
/// number of equations in a row without a body between them.
std::string why_no_structure(const Graph& graph, ParameterValues values);

/// True if all poles of a structure are those of its bodies, or at 0: one-way blocks, which only
/// read it, have no states, except integrators of outputs of bodies and of inputs.
bool has_poles_of_bodies_only(const Graph& graph);

}  // namespace titop::certification
