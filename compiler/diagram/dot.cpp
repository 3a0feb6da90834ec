#include <fmt/format.h>

#include <titop/compiler/diagram/dot.hpp>
#include <titop/compiler/diagram/picture.hpp>
#include <titop/compiler/diagram/text.hpp>

namespace titop {

std::string to_dot(const Stage& stage, const DotOptions& options) {
  const diagram::Picture p = diagram::picture(stage, options.fold);
  return fmt::format(
      "digraph {0} {{\n"
      "  graph [rankdir=TB nodesep=0.35 ranksep=0.4 fontname=\"Helvetica\" fontsize=14 "
      "fontcolor=\"{1}\" labelloc=b label=<{4}>];\n"
      "  node [fontname=\"Helvetica\" fontsize=11 fontcolor=\"{1}\" color=\"{2}\" height=0.2 "
      "width=0.2 margin=\"0.06,0.03\"];\n"
      "  edge [fontname=\"Helvetica\" fontsize=9 fontcolor=\"{3}\" color=\"{2}\" arrowsize=0.7];\n"
      "{5}{6}}}\n",
      diagram::quoted(stage.now().name), diagram::colour::ink, diagram::colour::line,
      diagram::colour::soft, diagram::draw_legend(p), diagram::draw_nodes(p),
      diagram::draw_wires(p) + diagram::draw_folded_wires(p));
}

std::string to_dot(const Diagram& diagram, const DotOptions& options) {
  return to_dot(as_written(diagram.graph()), options);
}

}  // namespace titop
