#pragma once

#include <string>
#include <titop/compiler/passes/stage.hpp>
#include <titop/graph/diagram.hpp>

namespace titop {

/// Options of `to_dot`.
struct DotOptions {
  /// Upper limit, approximate, of the number of blocks; larger subtrees are folded into one box
  /// each, with their number of blocks and states and their types. The parent of a block is the one
  /// that drives its acceleration; of a controller, the first block that it reads. The largest
  /// subtrees are opened first; of one block's children the largest are shown, eight at most, and
  /// the others share a box. 0: every block.
  int fold = 0;
};

/// Graphviz text of a diagram at any stage of the compiler: one box per node with its ports,
/// edges with size and frame, algebraic loops in colour, inverted channels marked. Node names in
/// the text are the user's own, so two runs give the same text. O(terms).
std::string to_dot(const Stage& stage, const DotOptions& options = {});
std::string to_dot(const Diagram& diagram, const DotOptions& options = {});

}  // namespace titop
