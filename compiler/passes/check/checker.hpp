#pragma once

#include <fmt/format.h>

#include <set>
#include <titop/compiler/passes/passes.hpp>
#include <unordered_map>

/// Common to the checks of a graph, and the checks themselves: each adds its mistakes, so that all
/// are reported at once.
namespace titop::passes {

/// Place where an item of the diagram was written: its source line, or its place in the diagram
/// file, whose lists have the same order.
struct Written {
  const SourceLine& where;
  const char* list;  ///< "equations"
  std::ptrdiff_t index;

  std::string text() const {
    return where.line() > 0 ? to_string(where)
                            : fmt::format("{}[{}] of the diagram file", list, index);
  }
};

/// Origin of an item of this list.
template <class List>
Written written(const List& list, const char* name, const typename List::value_type& item) {
  return {item.where, name, &item - list.data()};
}
inline Written written(const Graph& g, const Equation& e) {
  return written(g.equations, "equations", e);
}

struct Checker {
  const Graph& graph;
  std::vector<Mistake> mistakes;
  std::vector<Note> notes;
  std::unordered_map<std::string_view, int> node_index = {};
  std::set<std::string> reversed = {};  ///< rotations used in the wrong direction, by their lines

  explicit Checker(const Graph& g) : graph(g), mistakes(g.mistakes) {}

  /// -1 if no node has this name. The index is made if a rotation names its frames.
  int find_node(const std::string& name) {
    if (name.empty()) return -1;
    if (node_index.empty())
      for (std::size_t i = 0; i < graph.nodes.size(); ++i)
        node_index.emplace(graph.nodes[i].name, static_cast<int>(i));
    const auto found = node_index.find(name);
    return found == node_index.end() ? -1 : found->second;
  }

  void add(Code code, std::string message, std::vector<std::string> details, std::string hint) {
    mistakes.push_back({code, std::move(message), std::move(details), std::move(hint)});
  }
};

inline std::string line(const std::string& text, const Written& where) {
  return fmt::format("{:<50} {}", text, where.text());
}

inline std::string added_at(const Graph& graph, const Node& node) {
  return fmt::format("{} was added at {}", node.name, written(graph.nodes, "blocks", node).text());
}

/// Sizes, quantities and frames of the terms on right-hand sides (terms.cpp).
void check_equations(Checker& c);
void check_outputs(Checker& c);

/// Every direction of a channel and every one-way port is driven once (drives.cpp).
void check_drives(Checker& c);

/// Warnings of legal input that is rarely intended (rarely_meant.cpp): springs and dampers of wrong
/// sign, inputs without outputs, inputs that nothing reads. Notes inputs on a parent's force with
/// the sign +. For a diagram without mistakes.
void note_rarely_meant(Checker& c, ParameterValues values);

/// The angles of rotations that depend on parameters, or exceed a turn (rarely_meant.cpp).
std::vector<RotationAngle> rotation_angles(const Graph& g, ParameterValues values);

/// Child points that the modes of their body leave rigid in some directions, with another body
/// mounted there: truncated modes would bend under its loads (stiff_points.cpp).
void note_stiff_points(Checker& c, ParameterValues values);

/// Lines of parents, and of children whose point is held, of which no equation drives a shape
/// (free_lines.cpp): the edge bends freely behind its point.
void note_free_lines(Checker& c);

}  // namespace titop::passes
