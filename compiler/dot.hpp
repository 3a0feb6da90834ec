#pragma once

#include <string>
#include <titop/compiler/stage.hpp>
#include <titop/graph/diagram.hpp>

namespace titop {

/// Graphviz text of a diagram at any stage of the compiler: one box per node with its ports,
/// edges with size and frame, algebraic loops in colour, inverted channels marked. Node names in
/// the text are the user's own, so two runs give the same text. O(terms).
std::string to_dot(const Stage& stage);
std::string to_dot(const Diagram& diagram);

}  // namespace titop
