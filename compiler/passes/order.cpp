#include <fmt/format.h>

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/strong_components.hpp>
#include <titop/compiler/passes/incidence.hpp>
#include <titop/compiler/passes/passes.hpp>

namespace titop::passes {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

using Digraph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;

/// signal -> signals that its row needs; states need the inputs that move them.
std::vector<std::vector<int>> dependencies(const Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<std::vector<int>> needs(g.signals.size());
  for (const auto& [row, signal] : stage.matched.rows) {
    std::vector<int> list = mentioned(g, stage.rows[at(row)]);
    auto& to = needs[at(signal)];
    for (const int s : list)
      if (s != signal) to.push_back(s);
  }
  // Signals that share a row (a channel that is partly free) live and die together.
  std::vector<int> first_of(stage.rows.size(), -1);
  for (const auto& [row, signal] : stage.matched.rows) {
    int& first = first_of[at(row)];
    if (first < 0) first = signal;
    if (first == signal) continue;
    needs[at(first)].push_back(signal);
    needs[at(signal)].push_back(first);
  }
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
    const Node& node = g.nodes[at(i)];
    if (node.state < 0 || !g.signals[at(node.state)].active) continue;
    const Pattern moved = node.block->moved_by();
    for (int s = node.first_signal; s < end_signal(g, i); ++s)
      if (const Signal& u = g.signals[at(s)];
          u.role == Signal::Role::input && moved.middleCols(u.first, u.size).any())
        needs[at(node.state)].push_back(s);
  }
  for (auto& list : needs) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return needs;
}

std::vector<std::vector<int>> reversed(const std::vector<std::vector<int>>& needs) {
  std::vector<std::vector<int>> feeds(needs.size());
  for (int i = 0; i < static_cast<int>(needs.size()); ++i)
    for (const int j : needs[at(i)]) feeds[at(j)].push_back(i);
  return feeds;
}

std::vector<char> reach(const std::vector<std::vector<int>>& next, std::vector<int> front) {
  std::vector<char> seen(next.size(), 0);
  for (const int s : front) seen[at(s)] = 1;
  while (!front.empty()) {
    const int s = front.back();
    front.pop_back();
    for (const int t : next[at(s)])
      if (!seen[at(t)]) seen[at(t)] = 1, front.push_back(t);
  }
  return seen;
}

/// Signals that an input (or, without inputs, any state) moves, and that an output (or any state)
/// sees; the rest is set aside.
void set_aside(Stage& stage, const std::vector<std::vector<int>>& needs) {
  Graph& g = stage.graph;
  std::vector<int> sources, sinks, states;
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    if (g.signals[at(s)].role == Signal::Role::external) sources.push_back(s);
    if (g.signals[at(s)].role == Signal::Role::state && g.signals[at(s)].active)
      states.push_back(s);
  }
  for (const Output& o : g.outputs)
    for (const Term& t : o.terms) sinks.push_back(t.signal);
  // A released joint's wrench is 0 by choice: what it would move is still to be judged (solve).
  for (const Released& r : stage.released) sources.push_back(g.equations[at(r.equation)].target);
  if (g.inputs.empty()) sources.insert(sources.end(), states.begin(), states.end());
  if (g.outputs.empty()) sinks.insert(sinks.end(), states.begin(), states.end());
  const std::vector<char> moved = reach(reversed(needs), sources), seen = reach(needs, sinks);
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    Signal& sig = g.signals[at(s)];
    if (sig.role == Signal::Role::external || !sig.active || (moved[at(s)] && seen[at(s)]))
      continue;
    sig.active = false;
    sig.at_rest = !moved[at(s)];
    if (sig.role != Signal::Role::state) continue;
    const std::string& name = g.nodes[at(sig.node)].name;
    stage.notes.push_back({Note::Kind::removed, "order",
                           fmt::format("{} ({} states): no {} them", name, sig.size,
                                       moved[at(s)] ? "output sees" : "input moves")});
  }
}

void find_loops(Stage& stage, const std::vector<std::vector<int>>& needs) {
  const Graph& g = stage.graph;
  Digraph digraph(g.signals.size());
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s)
    if (is_unknown(g.signals[at(s)]))
      for (const int t : needs[at(s)])
        if (is_unknown(g.signals[at(t)]))
          boost::add_edge(static_cast<std::size_t>(s), static_cast<std::size_t>(t), digraph);
  std::vector<int> component(g.signals.size());
  const auto property = boost::get(boost::vertex_index, digraph);
  // Components come out dependencies first.
  const int count = boost::strong_components(
      digraph, boost::make_iterator_property_map(component.begin(), property));
  std::vector<Loop> loops(at(count));
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    if (!is_unknown(g.signals[at(s)])) continue;
    Loop& loop = loops[at(component[at(s)])];
    loop.signals.push_back(s);
    loop.unknowns += g.signals[at(s)].size;
  }
  std::vector<std::pair<int, int>> kept;
  std::vector<char> listed(stage.rows.size(), 0);  // signals that share a row share its loop
  for (const auto& [row, signal] : stage.matched.rows) {
    if (!g.signals[at(signal)].active) continue;
    if (!listed[at(row)]) loops[at(component[at(signal)])].rows.push_back(row);
    listed[at(row)] = 1;
    kept.emplace_back(row, signal);
  }
  stage.matched.rows = std::move(kept);
  loops.erase(
      std::remove_if(loops.begin(), loops.end(), [](const Loop& l) { return l.signals.empty(); }),
      loops.end());
  stage.loops = std::move(loops);
}

}  // namespace

Stage order(Stage stage) {
  const auto needs = dependencies(stage);
  set_aside(stage, needs);
  // Equations and rows follow their unknowns, not the signal that they are written for.
  std::vector<char> row_active(stage.rows.size(), 0);
  for (const auto& [row, signal] : stage.matched.rows)
    if (stage.graph.signals[at(signal)].active) row_active[at(row)] = 1;
  for (std::size_t r = 0; r < stage.rows.size(); ++r) {
    stage.rows[r].active = row_active[r];
    if (const int e = stage.rows[r].equation; e >= 0)
      stage.graph.equations[at(e)].active = row_active[r];
    else
      stage.graph.signals[at(stage.rows[r].output)].row = row_active[r];
  }
  find_loops(stage, needs);
  int coupled = 0, largest = 0;
  for (const Loop& loop : stage.loops)
    if (loop.signals.size() > 1) ++coupled, largest = std::max(largest, loop.unknowns);
  stage.notes.push_back(
      {Note::Kind::info, "order",
       fmt::format("{} algebraic loop{}{}", coupled, coupled == 1 ? "" : "s",
                   coupled ? fmt::format(", the largest of {} unknowns", largest) : "")});
  for (const Inversion& i : stage.inversions) {
    const Channel& c = stage.graph.channels[at(i.channel)];
    const bool child = c.takes == Takes::force;
    stage.notes.push_back(
        {Note::Kind::inverted, "match",
         fmt::format("{}: takes {}, gives {}", channel_name(stage.graph, i.channel),
                     name_of(stage.graph, child ? c.accel : c.force),
                     name_of(stage.graph, child ? c.force : c.accel))});
  }
  return stage;
}

}  // namespace titop::passes
