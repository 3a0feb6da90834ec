#include <titop/compiler/dot.hpp>
namespace titop {
std::string to_dot(const Stage& stage) { return "digraph \"" + stage.graph.name + "\" {}\n"; }
std::string to_dot(const Diagram& diagram) { return "digraph \"" + diagram.name() + "\" {}\n"; }
}  // namespace titop
