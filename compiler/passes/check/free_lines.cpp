#include <algorithm>
#include <map>
#include <titop/compiler/passes/check/checker.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::passes {
namespace {

using linalg::at;

/// Of a scalar channel "in.z2" of a body without a child point "in": that line of its parent, "in".
/// Empty for other channels.
std::string line_of_parent(const Interface& face, const ChannelSpec& channel) {
  const std::size_t dot = channel.name.rfind('.');
  if (channel.size != 1 || channel.takes != Takes::force || dot == std::string::npos) return {};
  std::string line = channel.name.substr(0, dot);
  return face.find_channel(line) < 0 ? line : std::string{};
}

bool is_driven(const Drive& drive) {
  return !drive.accel.empty() || !drive.force.empty() || !drive.added.empty();
}

/// A line of a node's parent.
struct FreeLine {
  std::vector<std::string> shapes = {};
  bool driven = false;
};

}  // namespace

void note_free_lines(Checker& c) {
  const Graph& g = c.graph;
  const Drives drives(g);
  for (const Node& node : g.nodes) {
    const Interface& face = node.block->interface();
    if (face.find_channel("parent") < 0) continue;
    std::map<std::string, FreeLine> lines;
    for (std::size_t i = 0; i < face.channels.size(); ++i) {
      const std::string name = line_of_parent(face, face.channels[i]);
      if (name.empty()) continue;
      FreeLine& line = lines[name];
      line.shapes.push_back(face.channels[i].name);
      line.driven = line.driven || is_driven(drives[at(node.first_channel) + i]);
    }
    for (const auto& [name, line] : lines)
      if (!line.driven)
        c.notes.push_back(
            {Note::Kind::warning, "check",
             fmt::format("{0}: its parent is the line {1}, of which the point alone is held: no "
                         "equation drives its shapes {2}, the edge bends freely there. Write "
                         "mount({0}.line(\"{1}\"), site) or ground({0}.line(\"{1}\")) to clamp it "
                         "along its whole length, or release its shapes",
                         node.name, name, detail::some_names(line.shapes))});
  }
}

}  // namespace titop::passes
