#include <fmt/format.h>

#include <titop/compiler/passes/check/checker.hpp>
#include <unordered_map>
#include <unordered_set>

namespace titop::passes {
namespace {

template <class List>
void check_names(Checker& c, const List& list, std::string_view subject, const char* list_name) {
  const auto place = [&](const auto& item) { return written(list, list_name, item).text(); };
  std::unordered_map<std::string_view, const typename List::value_type*> seen;
  seen.reserve(list.size());
  for (const auto& item : list) {
    if (item.name.empty()) {
      c.add(Code::duplicate_name, fmt::format("one {} has no name", subject),
            {"written at " + place(item)}, "give it a name of its own");
      continue;
    }
    const auto [first, is_new] = seen.emplace(item.name, &item);
    if (!is_new)
      c.add(Code::duplicate_name, fmt::format("two {}s are called {}", subject, item.name),
            {"the first is at " + place(*first->second), "the second is at " + place(item)},
            "names come out with the model: give each its own");
  }
}

/// "W(3)" is the third scalar of W, and may be a name of its own only if W has no third.
template <class List>
void check_scalar_names(Checker& c, const List& list, std::string_view subject,
                        const char* list_name) {
  const auto place = [&](const auto& item) { return written(list, list_name, item).text(); };
  std::unordered_map<std::string_view, const typename List::value_type*> declared;
  for (const auto& item : list) declared.emplace(item.name, &item);
  for (const auto& item : list)
    for (int i = 1; item.size > 1 && i <= item.size; ++i) {
      const auto found = declared.find(fmt::format("{}({})", item.name, i));
      if (found != declared.end())
        c.add(Code::duplicate_name,
              fmt::format("{} {} has the name of a scalar of {}", subject, found->first, item.name),
              {fmt::format("{} is at {}", found->first, place(*found->second)),
               fmt::format("{} is at {}", item.name, place(item))},
              "names come out with the model: give each its own");
    }
}

/// The matrices of blocks, which may be the user's own. Bodies of the same data share their block:
/// it is checked once.
void check_blocks(Checker& c, ParameterValues values) {
  std::unordered_set<const Block*> seen;
  for (const Node& node : c.graph.nodes) {
    if (node.block.use_count() > 1 && !seen.insert(node.block.get()).second) continue;
    std::vector<Mistake> found = mistakes_of(node.block->interface(), node.block->type());
    try {
      const auto more = mistakes_of(*node.block, *node.block->dynamics(values));
      found.insert(found.end(), more.begin(), more.end());
    } catch (const Error& error) {
      found.insert(found.end(), error.mistakes().begin(), error.mistakes().end());
    }
    for (const Mistake& m : found)
      c.add(m.code, fmt::format("{}: {}", node.name, m.message), {added_at(c.graph, node)}, m.hint);
  }
}

}  // namespace

Stage check(Stage stage) {
  const Graph& g = stage.written();
  Checker c(g);
  check_names(c, g.nodes, "node", "blocks");
  check_names(c, g.inputs, "input", "inputs");
  check_names(c, g.outputs, "output", "outputs");
  check_scalar_names(c, g.inputs, "input", "inputs");
  check_scalar_names(c, g.outputs, "output", "outputs");
  check_names(c, g.parameters, "parameter", "parameters");
  check_equations(c);
  check_drives(c);
  check_outputs(c);
  if (c.mistakes.empty()) check_blocks(c, stage.values);  // parameters have values that serve
  if (!c.mistakes.empty()) throw Error(std::move(c.mistakes));
  note_rarely_meant(c, stage.values);
  stage.angles = rotation_angles(g, stage.values);
  note_stiff_points(c, stage.values);
  stage.notes.insert(stage.notes.end(), c.notes.begin(), c.notes.end());
  return stage;
}

}  // namespace titop::passes
