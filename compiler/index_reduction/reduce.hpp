#pragma once

#include <titop/compiler/solve/factored.hpp>

/// Singular scenes that still have a proper transfer: massless junctions, springs in series, a
/// force on a massless point.
///
/// The joint system of the state space, 0 = L z + G x + H u, may be singular although the diagram's
/// equations are not: if y L = 0, they contain y G x + y H u = 0, a hidden constraint on the states
/// (the forces of two springs in series are equal). It makes one state depend on the others and on
/// u, and its derivative replaces one of the rows that y combines. This is repeated until L is
/// regular: the order is then the number of poles of the equations as written. Derivatives of
/// inputs that come in this way must not reach an output; states may be shifted by multiples of
/// inputs so that they do not.
///
/// A constraint without content (0 = 0) leaves something undetermined. If that is a motion on which
/// no output or state depends (undetermined.hpp), it is set to 0 instead, and noted.
namespace titop::detail {

/// Replaces k.joint and d.factors, which are singular, by regular ones; completes
/// k.stage.dependents and d.states; keeps the equations as written, undetermined motions at 0, in
/// k.before_reduce. A pivot below d.weak_pivots->least of its terms is 0. If no pivot was judged as
/// rounding before, and one of the regular system is, the reduction is done once more from the
/// equations as written, with that threshold; d.weak_pivots is then that of the result. Throws
/// improper (input, output, number of derivatives and the equation that causes it), or the errors
/// of solve::blame if a constraint is redundant or contradictory (with the signals that depend on
/// an undetermined motion), not_finite. O(bodies) per derivative, and for each missing pivot the
/// reach of its constraint: of a point without mass its neighbours.
void reduce(Skeleton& k, Factored& d);

}  // namespace titop::detail
