#include <fmt/format.h>

#include <titop/compiler/passes/check/checker.hpp>
#include <unordered_map>

namespace titop::passes {
namespace {

template <class List>
void check_names(Checker& c, const List& list, std::string_view what) {
  std::unordered_map<std::string_view, const std::source_location*> seen;
  seen.reserve(list.size());
  for (const auto& item : list) {
    if (item.name.empty()) {
      c.add(Code::duplicate_name, fmt::format("a {} has no name", what),
            {"written at " + to_string(item.where)}, "give it a name of its own");
      continue;
    }
    const auto [first, is_new] = seen.emplace(item.name, &item.where);
    if (!is_new)
      c.add(Code::duplicate_name, fmt::format("two {}s are called {}", what, item.name),
            {"the first is at " + to_string(*first->second),
             "the second is at " + to_string(item.where)},
            "names come out with the model: give each its own");
  }
}

/// "W(3)" is the third scalar of W, and may be a name of its own only where W has no third.
template <class List>
void check_scalar_names(Checker& c, const List& list, std::string_view what) {
  std::unordered_map<std::string_view, const std::source_location*> declared;
  for (const auto& item : list) declared.emplace(item.name, &item.where);
  for (const auto& item : list)
    for (int i = 1; item.size > 1 && i <= item.size; ++i) {
      const auto found = declared.find(fmt::format("{}({})", item.name, i));
      if (found != declared.end())
        c.add(Code::duplicate_name,
              fmt::format("{} {} has the name of a scalar of {}", what, found->first, item.name),
              {fmt::format("{} is at {}", found->first, to_string(*found->second)),
               fmt::format("{} is at {}", item.name, to_string(item.where))},
              "names come out with the model: give each its own");
    }
}

}  // namespace

Stage check(Stage stage) {
  const Graph& g = stage.written();
  Checker c(g);
  check_names(c, g.nodes, "node");
  check_names(c, g.inputs, "input");
  check_names(c, g.outputs, "output");
  check_scalar_names(c, g.inputs, "input");
  check_scalar_names(c, g.outputs, "output");
  check_names(c, g.parameters, "parameter");
  check_equations(c);
  check_drives(c);
  check_outputs(c);
  if (!c.mistakes.empty()) throw Error(std::move(c.mistakes));
  stage.notes.insert(stage.notes.end(), c.notes.begin(), c.notes.end());
  return stage;
}

}  // namespace titop::passes
