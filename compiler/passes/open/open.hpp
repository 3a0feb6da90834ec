#pragma once

#include <span>
#include <titop/compiler/passes/stage.hpp>

/// A diagram with parameters taken out: w and z of each are inputs and outputs.
namespace titop::passes {

/// A parameter to be opened, and the channel of an angle.
struct ToOpen {
  int parameter = -1;
  /// An angle has the tangent of a quarter of its deviation, which reaches a whole turn with twice
  /// as many pairs; else that of half of it.
  bool full_turn = false;
  /// First derivatives only: blocks without `opened` by differences of their matrices
  /// (compiler/passes/open/differences.hpp).
  bool differences = false;
};

/// The stage of a graph as `lower` has ordered it (Stage::source, with its motions) with these
/// parameters opened at `stage.values`:
///
///  - a block of that parameter is replaced by Block::opened;
///  - a factor k of a term k x becomes k x + scale w, with z = x;
///  - a rotation by the angle about a unit vector r becomes R (u + X' J w), with z = 2 X u + J w, R
///    the rotation at the nominal angle, X (2 x 3) an orthonormal basis of the plane across r, J =
///    [0, -1; 1, 0]: w = t z turns by 2 atan t more [Cayley]. An angle of n times the parameter is
///    n such turns.
///
/// At w = 0 it is the graph as it was. Rates and positions beyond an opened rotation get pairs of
/// their own in `lower` (lower/open_motions.hpp). Throws not_rational for a block without `opened`,
/// for an angle of a fraction of the parameter, and for a parameter that is both an angle and a
/// number. Parameters by differences are noted (Stage::notes, pass "open"). O(terms).
Stage open_parameters(const Stage& stage, std::span<const ToOpen> parameters);

}  // namespace titop::passes
