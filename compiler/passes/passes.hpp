#pragma once

#include <functional>
#include <span>
#include <titop/compiler/passes/stage.hpp>

/// The passes before numbers, in their order, from as_written(graph) on. Each is a pure function:
/// it takes a stage and returns the next one; it does not print, has no state, and throws only for
/// the user's mistakes, all of them together. Every pass keeps `transfer(graph,
/// s)`.
namespace titop::passes {

/// Sizes, quantities and frames agree; each channel is driven exactly once per degree of freedom;
/// names are unique. First, so that mistakes are reported in the user's own words.
/// Throws no_equation, two_equations, size, quantity, frame, unknown_name, duplicate_name,
/// not_finite. O(terms).
Stage check(Stage stage);

/// Sorts nodes, inputs and equations by name, nodes of a tree next to their neighbours; every
/// driven part gets exactly one equation; `+=`, reactions and positions are expanded; every term
/// has one numeric coefficient; Gain and Sum become equations. Positions and rates that are no
/// states get Integrators, listed, once per assembly; beyond opened parameters also pairs of their
/// own (lower/open_motions.hpp). Throws not_finite. O(terms).
Stage lower(Stage stage);

/// coefficient * signal.
struct NumericTerm {
  int signal = -1;
  Eigen::MatrixXd coefficient = {};
};

/// Calls take(origin, terms) with the terms of each of these equations and outputs (by their places
/// in Stage::origins) for other parameter values; stops if take returns false, and returns false.
/// Throws as `lower` does. O(these terms).
bool lower_again(const Stage& stage, const std::vector<int>& origins, ParameterValues values,
                 const std::function<bool(int, std::span<const NumericTerm>)>& take);

/// Warnings of angles of more than a turn at these values (angles are in radians): one for each.
std::vector<Note> degree_notes(const std::vector<RotationAngle>& angles, ParameterValues values);

/// Connected parts (ground not counted) without an output are set aside and listed; if the
/// diagram has no outputs at all, all states count as observable. O(terms).
Stage split(Stage stage);

/// Makes closed kinematic chains, through the ground or among bodies, consistent: if a closing
/// equation repeats others (two rigid bodies welded at two points, a planar mechanism of 6-dof
/// joints), the joint is released in these directions and listed, so that every remaining closing
/// equation is independent; the motion is the same. Points that the chains immobilise are listed:
/// outputs, and equations outside the chains, read 0 there instead of rounding. Throws
/// kinematic_loop if the geometry does not close, and if a body on the chain does not define its
/// kinematics. O(terms) if all chains are open; about linear in the loops of a ladder or a truss,
/// n^1.5 in a planar grid of flexible bodies; at worst O(rows width columns), for connected sets of
/// loops in which no body belongs to one alone: the width is that of the front along them,
/// independent of names (compiler/loops/along.hpp).
Stage chains(Stage stage);

/// Matches every row with its unknown: maximum bipartite matching by whole signals from each
/// channel's default, by scalars only for the remaining rows, and through states for those that
/// still remain (a point without mass between springs: handled by `reduce`). Finds the inversions.
/// Throws structure, with both sides of every deficient part (Dulmage-Mendelsohn) and the channels
/// to be driven on their other side. O(terms) for trees.
Stage match(Stage stage);

/// Block triangular form: strong components are the algebraic loops, dependencies first. Signals
/// that are unreachable or unobservable are set aside and listed; without inputs (outputs) all
/// states count as reachable (observable). Unreachable loops are kept if they are observable: they
/// are at rest only if they have one solution. O(terms).
Stage order(Stage stage);

/// Determines the dependent states, on position and on velocity level: dependent coordinates of
/// closed chains, and Integrators of accelerations or rates whose integrals are states already.
/// They are eliminated (Stage::dependents); states that an input prescribes are kept. Ranks are
/// decided after scaling; decisions near the tolerance are noted with both orders. Cost as
/// `chains`.
Stage close(Stage stage);

/// The graph's invariants, checked after every pass, in a release after `lower` and the last
/// one; throws std::logic_error (a fault of the library). O(terms).
void verify(const Stage& stage);

}  // namespace titop::passes
