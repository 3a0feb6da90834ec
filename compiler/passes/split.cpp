#include <fmt/format.h>

#include <titop/compiler/passes/passes.hpp>
#include <titop/compiler/passes/union_find.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::passes {
namespace {

using linalg::at;

/// Connected parts of the signals: a block joins its own, an equation joins its target and terms.
UnionFind connect(const Graph& g) {
  UnionFind parts(static_cast<int>(g.signals.size()));
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i)
    for (int s = g.nodes[at(i)].first_signal + 1; s < end_signal(g, i); ++s) parts.unite(s - 1, s);
  for (const Equation& e : g.equations)
    for (const Term& t : e.terms) parts.unite(e.target, t.signal);
  return parts;
}

}  // namespace

Stage split(Stage stage) {
  Graph& g = stage.graph;
  UnionFind parts = connect(g);
  std::vector<char> seen(g.signals.size(), 0);
  for (const Output& o : g.outputs)
    for (const Term& t : o.terms) seen[at(parts.find(t.signal))] = 1;
  for (const Node& node : g.nodes) {
    const int root = parts.find(node.first_signal);
    if (seen[at(root)] || g.outputs.empty()) continue;
    stage.notes.push_back(
        {Note::Kind::removed, "split", fmt::format("{}: no output is connected to it", node.name)});
  }
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    Signal& sig = g.signals[at(s)];
    const int root = parts.find(s);
    if (sig.role != Signal::Role::external)
      sig.row = sig.active = seen[at(root)] || g.outputs.empty();
  }
  for (Equation& e : g.equations) e.active = g.signals[at(e.target)].active;
  return stage;
}

}  // namespace titop::passes
