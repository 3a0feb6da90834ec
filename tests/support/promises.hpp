#pragma once

#include <titop/compiler/passes/stage.hpp>

/// The postcondition of each pass, implemented independently; std::logic_error if it is violated.
namespace titop_test {

/// One numeric coefficient per term, every degree of freedom of a channel driven once.
void demand_lowered(const titop::Stage& stage);

/// Active parts are connected with an input and an output, unless the diagram has none at all; all
/// such parts are active.
void demand_split(const titop::Stage& stage);

/// No closing equation is redundant: bodies and motions, as one matrix on all positions,
/// coordinates and prescribed motions, have full row rank.
void demand_not_redundant(const titop::Stage& stage);

/// Every eliminated state is the given sum of the others for all motions that bodies and equations
/// allow, and as many states remain as the rank of the states on the null space of that matrix, on
/// position and on velocity level. Integrators not counted.
void demand_closed(const titop::Stage& stage);

/// Every row and every unknown in use are matched, each of them once.
void demand_matched(const titop::Stage& stage);

/// Every unknown in one loop, dependencies first.
void demand_ordered(const titop::Stage& stage);

}  // namespace titop_test
