#pragma once

#include <titop/analysis/reduction/probes.hpp>

/// Bodies with fewer coordinates, if the whole is too large for one eigenproblem. For the
/// library's own files.
namespace titop::detail {

/// A graph of smaller bodies, and the changes of each.
struct SmallerBodies {
  Graph graph;
  int before = 0, after = 0;      ///< coordinates of all blocks with modes
  std::vector<std::string> text;  ///< "b1 and b2: 12 modes and 9 vectors of 342", one per block
};

/// Keeps the modes with the largest effect, of all bodies, until the effects of the others sum to
/// `share` of the pairs' peaks. The dropped modes of a body are replaced by static vectors,
/// Omega^-2 of W over these modes, for the ports with any transfer; if these have no effect
/// either, the body becomes rigid. Then eta = V eta_r with V orthonormal: mass, symmetry and sign
/// of stiffness and damping are preserved; the damping of the vectors is that of their own
/// diagonal. Modes of equal frequency are kept or dropped together; nodes that share a block keep
/// the same modes, so that twins remain twins. An Lti keeps oscillators likewise (oscillators.hpp),
/// with vectors for its outputs, too, and all its other states. O(modes).
SmallerBodies smaller_bodies(const Graph& graph, const std::vector<ModeEffects>& effects,
                             double share);

}  // namespace titop::detail
