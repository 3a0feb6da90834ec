#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <optional>
#include <titop/compiler/system/system.hpp>
#include <vector>

/// The common input of all other methods: the scene as the input format of control-engineering
/// tools.
namespace titop_bench {

using Sparse = Eigen::SparseMatrix<double>;

/// xdot = A x + B u, y = C x + D u, block diagonal in the order in which the diagram declares the
/// blocks; u = K y + E w, z = F y + G w. A channel that the scene drives against its block's
/// default is inverted in the block beforehand, as the paper does by hand; if the block alone
/// cannot be inverted (a hinge), its input is one more unknown: a unit gain q with `input = q out,
/// q in = q out + (the term that must be zero)`.
struct Network {
  Sparse A, B, C, D, K, E, F, G;
  std::vector<std::array<int, 3>> blocks;  ///< states, inputs and outputs of each

  int states() const { return static_cast<int>(A.rows()); }
};

/// The network of a compiled scene, at its parameter values. O(scalars log) except for the
/// inversions.
Network network_of(const titop::System& system);

/// None if this form cannot express the scene: ties of parts of a port, channels of points that
/// modes do not move in all directions.
std::optional<Network> network_if_any(const titop::System& system);

}  // namespace titop_bench
