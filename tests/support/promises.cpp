#include "support/promises.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <titop/compiler/passes/incidence.hpp>
#include <utility>

namespace titop_test {

using namespace titop;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void demand(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error("promise broken: " + what);
}

}  // namespace

void demand_lowered(const Stage& stage) {
  const Graph& g = stage.graph;
  for (std::size_t i = 1; i < g.nodes.size(); ++i)
    demand(natural_compare(g.nodes[i - 1].name, g.nodes[i].name) < 0, "nodes stand by name");
  for (const Node& node : g.nodes)
    demand(node.lowered == node.block->is_algebraic(), node.name + " is an equation");
  const auto lowered = [&](const std::vector<Term>& terms) {
    return std::all_of(terms.begin(), terms.end(), [](const Term& t) {
      return t.of == Term::Of::signal && t.sign == 1 && t.factors.size() == 1 &&
             std::holds_alternative<Matrix>(t.factors.front());
    });
  };
  std::vector<int> driven(g.signals.size(), 0);
  for (const Equation& e : g.equations) {
    demand(!e.accumulate, "no += is left");
    demand(lowered(e.terms), "one coefficient per term in " + print(g, e));
    driven[at(e.target)] +=
        e.part.whole() ? g.signals[at(e.target)].size : static_cast<int>(e.part.rows.rows());
  }
  for (const Output& o : g.outputs)
    demand(lowered(o.terms), "one coefficient per term in " + o.name);
  for (const Channel& c : g.channels)
    demand(driven[at(c.accel)] + driven[at(c.force)] == c.size,
           "every degree of freedom of a channel is driven once");
}

namespace {

/// Sets the marks of everything that is joined to a marked signal, step by step.
void spread(const Graph& g, std::vector<char>& marked) {
  const auto join = [&](const std::vector<int>& signals) {
    const bool any =
        std::any_of(signals.begin(), signals.end(), [&](int s) { return marked[at(s)] != 0; });
    bool changed = false;
    for (const int s : signals) changed |= any && !std::exchange(marked[at(s)], 1);
    return changed;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
      std::vector<int> own;
      for (int s = g.nodes[at(i)].first_signal; s < end_signal(g, i); ++s) own.push_back(s);
      changed |= join(own);
    }
    for (const Equation& e : g.equations) {
      std::vector<int> mentioned{e.target};
      for (const Term& t : e.terms) mentioned.push_back(t.signal);
      changed |= join(mentioned);
    }
  }
}

}  // namespace

void demand_split(const Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<char> driven(g.signals.size(), g.inputs.empty());
  std::vector<char> seen(g.signals.size(), g.outputs.empty());
  for (const Input& i : g.inputs) driven[at(i.signal)] = 1;
  for (const Output& o : g.outputs)
    for (const Term& t : o.terms) seen[at(t.signal)] = 1;
  spread(g, driven);
  spread(g, seen);
  for (std::size_t s = 0; s < g.signals.size(); ++s)
    demand(g.signals[s].role == Signal::Role::external ||
               g.signals[s].active == (driven[s] && seen[s]),
           "set aside is what has no input or no output: " + name_of(g, static_cast<int>(s)));
}

namespace {

using Edges = std::set<std::pair<int, int>>;

/// Between channels, and the ground (-1): motions that bodies carry on and equations impose.
Edges chain_edges(const Stage& stage) {
  const Graph& g = stage.graph;
  Edges edges;
  for (const Node& node : g.nodes)
    if (const auto k = node.block->kinematics(stage.values))
      for (int i = 0; i < static_cast<int>(k->tau.size()); ++i)
        if (i != k->reference && !k->tau[at(i)].isZero(0))
          edges.emplace(node.first_channel + k->reference, node.first_channel + i);
  for (const Equation& e : g.equations) {
    const Signal& target = g.signals[at(e.target)];
    if (!e.active || target.channel < 0 || target.quantity != Quantity::acceleration) continue;
    if (channel_name(g, target.channel) == g.nodes[at(target.node)].name) continue;  // a joint's
    const bool prescribed = std::any_of(e.terms.begin(), e.terms.end(), [&](const Term& t) {
      const Signal& s = g.signals[at(t.signal)];
      return s.channel < 0 || s.quantity != Quantity::acceleration;
    });
    if (prescribed) continue;
    if (e.terms.empty()) edges.emplace(target.channel, -1);
    for (const Term& t : e.terms) edges.emplace(target.channel, g.signals[at(t.signal)].channel);
  }
  return edges;
}

}  // namespace

/// Takes off what hangs at one end only until nothing is left.
void demand_open(const Stage& stage) {
  Edges edges = chain_edges(stage);
  for (std::size_t before = edges.size() + 1; before > edges.size();) {
    before = edges.size();
    std::map<int, int> degree;
    for (const auto& [a, b] : edges) ++degree[a], ++degree[b];
    std::erase_if(edges,
                  [&](const auto& e) { return degree[e.first] < 2 || degree[e.second] < 2; });
  }
  demand(edges.empty(), "every kinematic chain is open");
}

void demand_matched(const Stage& stage) {
  std::vector<int> of_row(stage.rows.size(), 0), of_signal(stage.graph.signals.size(), 0);
  for (const auto& [row, signal] : stage.matched.rows) ++of_row[at(row)], ++of_signal[at(signal)];
  for (std::size_t r = 0; r < of_row.size(); ++r)
    demand(!stage.rows[r].active || of_row[r] == 1 || of_row[r] == stage.rows[r].size,
           "every row has its unknown");
  for (std::size_t s = 0; s < of_signal.size(); ++s) {
    const Signal& signal = stage.graph.signals[s];
    const bool unknown = passes::is_unknown(signal);
    demand(unknown ? of_signal[s] == 1 || of_signal[s] == signal.size : of_signal[s] == 0,
           "every unknown has its row: " + name_of(stage.graph, static_cast<int>(s)));
  }
}

void demand_ordered(const Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<int> place(g.signals.size(), -1);
  for (std::size_t l = 0; l < stage.loops.size(); ++l)
    for (const int s : stage.loops[l].signals) {
      demand(place[at(s)] < 0, "every unknown is in one loop");
      place[at(s)] = static_cast<int>(l);
    }
  for (std::size_t s = 0; s < g.signals.size(); ++s)
    demand((place[s] >= 0) == passes::is_unknown(g.signals[s]), "every unknown is in a loop");
  for (std::size_t l = 0; l < stage.loops.size(); ++l)
    for (const int row : stage.loops[l].rows)
      for (const int s : passes::mentioned(g, stage.rows[at(row)]))
        demand(!passes::is_unknown(g.signals[at(s)]) || place[at(s)] <= static_cast<int>(l),
               "dependencies first");
}

}  // namespace titop_test
