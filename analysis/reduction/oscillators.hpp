#pragma once

#include <optional>
#include <titop/graph/graph.hpp>
#include <vector>

/// An Lti that contains modes, as a structure of modal blocks. For the library's own files.
namespace titop::detail {

/// An Lti in second order, as far as it has one: out = out of `rest` + c_q q + c_v q', with
///
///     q'' + diag(damping) q' + diag(stiffness) q = b in
///
/// One coordinate for each uncoupled part of 2 x 2 with a spring and without negative damping that
/// inputs move in one direction: [0 w; -w -2 xi w], [0 1; -w^2 -2 xi w], [re im; -im re].
/// Coordinates are in units, powers of two, in which inputs move them as far as they move outputs,
/// as mass-normalised modes of a structure do. `rest` has the other states and the direct term.
struct Oscillators {
  Eigen::VectorXd stiffness, damping;  ///< N
  Eigen::MatrixXd b;                   ///< N x inputs
  Eigen::MatrixXd c_q, c_v;            ///< outputs x N
  Dynamics rest;
  /// States of the Lti that were made q and q', and those of `rest`; empty if it is projected.
  std::vector<int> q = {}, v = {}, others = {};
};

/// None if the block is no Lti, or has no such part. O(states^2).
std::optional<Oscillators> oscillators(const Block& block);

/// The Lti with q, q' and the states of `rest` in the places from which they come, so that messages
/// name them as the user does; of projected motions the states of `rest`, then q, then q'.
BlockPtr lti_of(const Oscillators& o);

/// The graph with the oscillators of every Lti as coordinates and rates, on which `coordinates`
/// relies, whatever the units of their states; none if there are none.
std::optional<Graph> in_coordinates(const Graph& graph);

/// The motions q = V q_r, with these stiffnesses; the damping of each is its own, V' damping V.
Oscillators projected(const Oscillators& o, const Eigen::MatrixXd& V,
                      const Eigen::VectorXd& stiffness);

}  // namespace titop::detail
