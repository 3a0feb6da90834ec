#pragma once

#include <titop/compiler/passes/stage.hpp>
#include <vector>

namespace titop::loops {

/// Ties and bodies on the ways round the closed chains, after all passes.
struct ChainParts {
  std::vector<int> equations;  ///< of Stage::graph: ties
  std::vector<int> nodes;      ///< bodies
};

/// The equations and bodies by which the closed chains meet: others move a chain as a whole.
/// O(points of the chains).
ChainParts parts_of_chains(const Stage& stage);

}  // namespace titop::loops
