#include <titop/analysis/distributed/with_blocks.hpp>
#include <titop/graph/linalg/index.hpp>
#include <utility>

namespace titop::detail {
namespace {

using linalg::at;

/// Moves every reference to a signal.
void renumber(Graph& g, const std::vector<int>& place) {
  const auto move = [&](int& signal) {
    if (signal >= 0) signal = place[at(signal)];
  };
  const auto move_terms = [&](std::vector<Term>& terms) {
    for (Term& t : terms) move(t.signal);
  };
  for (Channel& c : g.channels) move(c.accel), move(c.force);
  for (Input& i : g.inputs) move(i.signal);
  for (Equation& e : g.equations) move(e.target), move_terms(e.terms);
  for (Output& o : g.outputs) move_terms(o.terms);
}

}  // namespace

Graph with_blocks(Graph g, const std::vector<BlockPtr>& blocks) {
  const std::vector<Signal> before = std::exchange(g.signals, {});
  std::vector<int> place(before.size());
  const auto keep = [&](std::size_t signal) {
    place[signal] = static_cast<int>(g.signals.size());
    g.signals.push_back(before[signal]);
  };
  std::size_t next = 0;
  for (std::size_t n = 0; n < g.nodes.size(); ++n) {
    Node& node = g.nodes[n];
    for (; next < at(node.first_signal); ++next) keep(next);  // external inputs between nodes
    node.first_signal = static_cast<int>(g.signals.size());
    for (; next < at(node.end_signal); ++next)
      if (!blocks[n] || before[next].role != Signal::Role::state) keep(next);
    if (blocks[n]) node.block = blocks[n];
    const int states = static_cast<int>(node.block->interface().states.size());
    node.state = states > 0 ? static_cast<int>(g.signals.size()) - (blocks[n] ? 0 : 1) : -1;
    if (blocks[n] && states > 0)
      g.signals.push_back(
          {.role = Signal::Role::state, .node = static_cast<int>(n), .size = states});
    node.end_signal = static_cast<int>(g.signals.size());
  }
  for (; next < before.size(); ++next) keep(next);
  renumber(g, place);
  return g;
}

}  // namespace titop::detail
