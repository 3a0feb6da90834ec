#include <fmt/format.h>

#include <titop/compiler/diagram/dot.hpp>
#include <titop/compiler/diagram/picture.hpp>
#include <titop/compiler/diagram/text.hpp>

namespace titop {

std::string to_dot(const Stage& stage, const DotOptions& options) {
  const dot::Picture p = dot::picture(stage, options.fold);
  return fmt::format(
      "digraph {0} {{\n"
      "  graph [rankdir=TB nodesep=0.35 ranksep=0.4 fontname=\"Helvetica\" fontsize=14 "
      "fontcolor=\"{1}\" labelloc=b label=<{4}>];\n"
      "  node [fontname=\"Helvetica\" fontsize=11 fontcolor=\"{1}\" color=\"{2}\" height=0.2 "
      "width=0.2 margin=\"0.06,0.03\"];\n"
      "  edge [fontname=\"Helvetica\" fontsize=9 fontcolor=\"{3}\" color=\"{2}\" arrowsize=0.7];\n"
      "{5}{6}}}\n",
      dot::quoted(stage.now().name), dot::colour::ink, dot::colour::line, dot::colour::soft,
      dot::draw_legend(p), dot::draw_nodes(p), dot::draw_wires(p) + dot::draw_folded_wires(p));
}

std::string to_dot(const Diagram& diagram, const DotOptions& options) {
  return to_dot(as_written(diagram.graph()), options);
}

}  // namespace titop
