#pragma once

#include <titop/compiler/economy/probes.hpp>

/// Bodies with fewer coordinates, where the whole is too large for one eigenproblem. For the
/// compiler's own files.
namespace titop::detail {

/// A graph of smaller bodies, and what was done to which.
struct SmallerBodies {
  Graph graph;
  int before = 0, after = 0;      ///< coordinates of all bodies
  std::vector<std::string> text;  ///< "b1 and b2: 12 modes and 9 vectors of 342", one per block
};

/// Of all bodies' modes the ones with the largest effect are kept, until the effects of the rest
/// sum to `share` of the pairs' peaks. In the place of what a body loses it gets static vectors,
/// Omega^-2 of W over the modes that go, for the ports where anything passes; where even those do
/// nothing it becomes rigid. Then eta = V eta_r with V orthonormal: mass, symmetry and sign of
/// stiffness and damping stay, damping of the vectors is that of their own diagonal. Modes of equal
/// frequency stay or go together, nodes that share a block have the same fewer modes, so that
/// twins stay twins. O(modes).
SmallerBodies smaller_bodies(const Graph& graph, const std::vector<ModeEffects>& effects,
                             double share);

}  // namespace titop::detail
