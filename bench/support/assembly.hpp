#pragma once

#include <Eigen/SparseCore>
#include <titop/graph/diagram.hpp>
#include <vector>

#include "support/network.hpp"

/// The common input of all other methods for closed chains: bodies and joints written out.
namespace titop_bench {

/// [M + D/s + K/s^2, G'; G, 0] [a; l] = [B w; 0], z = C a. Coordinates of each body, by their
/// accelerations a (by positions, s^2 M + s D + K, an LU loses up to three digits more): its point
/// P (6), then its modes clamped there; one row of G and one constraint force in l per degree of
/// freedom that a joint locks. Nothing is inverted or eliminated beforehand.
struct Assembly {
  Sparse M, D, K, G, B, C;
  std::vector<int> bodies;  ///< coordinates of each, in the order of the diagram
  std::vector<int> joints;  ///< rows of each, in the order of the diagram
};

/// The assembly of a diagram of rigid and flexible bodies, mounted and welded as a whole (no
/// hinges), with inputs that are wrenches and outputs that are accelerations; throws logic_error at
/// anything else. At the nominal values of its parameters.
Assembly assemble(const titop::Diagram& diagram);

}  // namespace titop_bench
