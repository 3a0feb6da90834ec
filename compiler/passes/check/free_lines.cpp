#include <algorithm>
#include <map>
#include <titop/compiler/passes/check/checker.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::passes {
namespace {

using linalg::at;

/// The line "in" of a scalar channel "in.z2"; empty for other channels.
std::string line_of(const ChannelSpec& channel) {
  const std::size_t dot = channel.name.rfind('.');
  if (channel.size != 1 || channel.takes != Takes::force || dot == std::string::npos) return {};
  return channel.name.substr(0, dot);
}

bool is_driven(const Drive& drive) {
  return !drive.accel.empty() || !drive.force.empty() || !drive.added.empty();
}

/// A line of a node: of the child of its name, or of the parent.
struct FreeLine {
  std::vector<std::string> shapes = {};
  bool driven = false;
};

std::map<std::string, FreeLine> lines_of(const Node& node, const Drives& drives) {
  const Interface& face = node.block->interface();
  std::map<std::string, FreeLine> lines;
  for (std::size_t i = 0; i < face.channels.size(); ++i) {
    const std::string name = line_of(face.channels[i]);
    if (name.empty()) continue;
    FreeLine& line = lines[name];
    line.shapes.push_back(face.channels[i].name);
    line.driven = line.driven || is_driven(drives[at(node.first_channel) + i]);
  }
  return lines;
}

/// Empty for a child whose point is not held.
std::string warning(const Node& node, const std::string& name, const FreeLine& line,
                    const Drives& drives) {
  const int child = node.block->interface().find_channel(name);
  const bool of_parent = child < 0;
  if (!of_parent && drives[at(node.first_channel) + at(child)].accel.empty()) return {};
  return fmt::format(
      "{0}: its {2} is the line {1}, of which the point alone is held: no equation drives its "
      "shapes {3}, the edge bends freely there. Write {4}({0}.line(\"{1}\"), site) or "
      "ground({0}.line(\"{1}\")) to clamp it along its whole length, weld({0}.line(\"{1}\"), line) "
      "to join it to another edge, or release its shapes",
      node.name, name, of_parent ? "parent" : "child", detail::some_names(line.shapes),
      of_parent ? "mount" : "weld");
}

}  // namespace

void note_free_lines(Checker& c) {
  const Drives drives(c.graph);
  for (const Node& node : c.graph.nodes) {
    if (node.block->interface().find_channel("parent") < 0) continue;
    for (const auto& [name, line] : lines_of(node, drives)) {
      if (line.driven) continue;
      std::string text = warning(node, name, line, drives);
      if (!text.empty()) c.notes.push_back({Note::Kind::warning, "check", std::move(text)});
    }
  }
}

}  // namespace titop::passes
