#pragma once

#include <string>
#include <titop/graph/graph.hpp>
#include <vector>

/// Groups the blocks of a large diagram into boxes.
namespace titop::diagram {

struct Fold {
  /// A box for several blocks: whole subtrees.
  struct Box {
    std::vector<int> nodes;  ///< all of them, in natural order of their names
    std::vector<int> tops;   ///< the topmost of them
  };
  std::vector<Box> boxes;
  std::vector<int> box_of;  ///< per node: its box, -1 for a block that is shown individually
};

/// At most `most` blocks and boxes, if that is two or more (blocks without parent share a box,
/// too); 0: no box. The largest subtrees are opened first; of a block's children the largest are
/// shown, eight at most, and the others share a box. O(nodes log nodes + terms).
Fold fold(const Graph& graph, int most);

}  // namespace titop::diagram
