#include <fmt/format.h>

#include <algorithm>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/strong_components.hpp>
#include <titop/compiler/passes/arrows.hpp>
#include <titop/compiler/passes/incidence.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/ahead.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::passes {
namespace {

using linalg::at;

/// signal -> signals that its row needs; states need the inputs that move them.
Arrows dependencies(const Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<std::pair<int, int>> needs;
  needs.reserve(2 * g.signals.size());  // of a two-port block: about as many as there will be
  std::vector<int> list;
  Mentioned mentioned(g);
  for (const auto& [row, signal] : stage.matched.rows) {
    list.clear();
    mentioned.add(stage.rows[at(row)], list);
    for (const int s : list)
      if (s != signal) needs.emplace_back(signal, s);
  }
  // Signals that share a row (a channel that is partly free) are needed together or not at all.
  std::vector<int> first_of(stage.rows.size(), -1);
  for (const auto& [row, signal] : stage.matched.rows) {
    int& first = first_of[at(row)];
    if (first < 0) first = signal;
    if (first == signal) continue;
    needs.emplace_back(first, signal);
    needs.emplace_back(signal, first);
  }
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
    const Node& node = g.nodes[at(i)];
    fetch_ahead(g, at(i));
    if (node.state < 0 || !g.signals[at(node.state)].active) continue;
    const Pattern moved = node.block->moved_by();
    for (int s = node.first_signal; s < end_signal(g, i); ++s)
      if (const Signal& u = g.signals[at(s)];
          u.role == Signal::Role::input && moved.middleCols(u.first, u.size).any())
        needs.emplace_back(node.state, s);
  }
  return Arrows(needs, g.signals.size());
}

std::vector<char> reach(const Arrows& next, std::vector<int> front) {
  std::vector<char> seen(at(next.count()), 0);
  for (const int s : front) seen[at(s)] = 1;
  while (!front.empty()) {
    const int s = front.back();
    front.pop_back();
    for (const int t : next.from(s))
      if (!seen[at(t)]) seen[at(t)] = 1, front.push_back(t);
  }
  return seen;
}

using Digraph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property,
                                                   boost::no_property, boost::no_property, int>;

using Vertex = boost::graph_traits<Digraph>::vertex_descriptor;

/// Strong component of every unknown signal; components come out dependencies first. An input that
/// reaches one signal of a component reaches all of them; likewise for outputs.
struct StrongComponents {
  std::vector<int> of;
  std::vector<std::size_t> size;  ///< in signals
};

StrongComponents components(const Graph& g, const Arrows& needs) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(needs.arrows() + at(needs.count()));
  for (int s = 0; s < needs.count(); ++s)
    if (is_unknown(g.signals[at(s)]))
      for (const int t : needs.from(s))
        if (is_unknown(g.signals[at(t)])) edges.emplace_back(s, t);
  // All vertices are reached from one additional vertex: a search from each of them would need a
  // stack of its own. It is the last component, by itself.
  const int all = needs.count();
  for (int s = 0; s < all; ++s) edges.emplace_back(all, s);
  const Digraph digraph(boost::edges_are_sorted, edges.begin(), edges.end(), all + 1);
  std::vector<int> component(at(all + 1)), root(at(all + 1)), time(at(all + 1));
  std::vector<boost::default_color_type> color(at(all + 1));
  const auto index = boost::get(boost::vertex_index, digraph);
  const auto map = [&](auto& list) {
    return boost::make_iterator_property_map(list.begin(), index);
  };
  const int count = boost::strong_components(digraph, map(component),
                                             boost::root_map(map(root))
                                                 .color_map(map(color))
                                                 .discover_time_map(map(time))
                                                 .root_vertex(static_cast<Vertex>(all)));
  component.pop_back();
  StrongComponents result{std::move(component), std::vector<std::size_t>(at(count - 1), 0)};
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s)
    if (is_unknown(g.signals[at(s)])) ++result.size[at(result.of[at(s)])];
  return result;
}

/// Keeps signals that an input (or, without inputs, any state) moves, and that an output (or any
/// state) sees; sets the others aside. Exception: loops that are seen are kept, since a loop
/// without input is at rest only if it has one solution.
void set_aside(Stage& stage, const Arrows& needs, const StrongComponents& parts) {
  Graph& g = stage.graph;
  std::vector<int> sources, sinks, states;
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    if (g.signals[at(s)].role == Signal::Role::external) sources.push_back(s);
    if (g.signals[at(s)].role == Signal::Role::state && g.signals[at(s)].active)
      states.push_back(s);
  }
  for (const Output& o : g.outputs)
    for (const Term& t : o.terms) sinks.push_back(t.signal);
  // A released joint's own wrench is 0 by choice: its effect is judged later (solve).
  for (const Released& r : stage.released) sources.push_back(g.equations[at(r.equation)].target);
  if (g.inputs.empty()) sources.insert(sources.end(), states.begin(), states.end());
  if (g.outputs.empty()) sinks.insert(sinks.end(), states.begin(), states.end());
  const Arrows readers = needs.reversed();
  const std::vector<char> moved = reach(readers, sources), seen = reach(needs, sinks);
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    Signal& sig = g.signals[at(s)];
    if (sig.role == Signal::Role::external || !sig.active || (moved[at(s)] && seen[at(s)]))
      continue;
    if (is_unknown(sig) && seen[at(s)] && parts.size[at(parts.of[at(s)])] > 1) continue;
    sig.active = false;
    sig.at_rest = !moved[at(s)];
    if (sig.role != Signal::Role::state) continue;
    const std::string& name = g.nodes[at(sig.node)].name;
    stage.notes.push_back({Note::Kind::removed, "order",
                           fmt::format("{} ({} states): no {} them", name, sig.size,
                                       moved[at(s)] ? "output sees" : "input moves")});
  }
}

void find_loops(Stage& stage, const StrongComponents& parts) {
  const Graph& g = stage.graph;
  const std::vector<int>& component = parts.of;
  std::vector<Loop> loops(parts.size.size());
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    if (!is_unknown(g.signals[at(s)])) continue;
    Loop& loop = loops[at(component[at(s)])];
    if (loop.signals.empty()) {
      loop.signals.reserve(parts.size[at(component[at(s)])]);
      loop.rows.reserve(parts.size[at(component[at(s)])]);
    }
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
  const StrongComponents parts = components(stage.graph, needs);
  set_aside(stage, needs, parts);
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
  find_loops(stage, parts);
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
