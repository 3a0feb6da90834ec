#include <algorithm>
#include <numeric>
#include <titop/compiler/passes/lower/along_trees.hpp>
#include <titop/compiler/passes/lower/by_name.hpp>
#include <titop/graph/linalg/index.hpp>
#include <unordered_map>

namespace titop::passes {
namespace {

using linalg::at;

template <class List>
std::vector<int> sorted_by_name(const List& list) {
  std::vector<int> order(list.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&](int a, int b) {
    return natural_compare(list[at(a)].name, list[at(b)].name) < 0;
  };
  if (!std::is_sorted(order.begin(), order.end(), before))
    std::sort(order.begin(), order.end(), before);
  return order;
}

/// The nodes are scattered in memory: they are prefetched 2 kAhead steps ahead, their blocks
/// kAhead.
constexpr std::size_t kAhead = 8;
void fetch(const void* p) { __builtin_prefetch(p); }

}  // namespace

Graph by_name(const Graph& g) {
  Graph out;
  out.name = g.name;
  out.parameters = g.parameters;
  out.nodes.reserve(g.nodes.size());
  out.channels.reserve(g.channels.size());
  out.signals.reserve(g.signals.size());
  std::vector<int> signal(g.signals.size(), -1);
  const std::vector<int> order = along_trees(g, sorted_by_name(g.nodes));
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k + 2 * kAhead < order.size()) fetch(&g.nodes[at(order[k + 2 * kAhead])]);
    if (k + kAhead < order.size()) fetch(g.nodes[at(order[k + kAhead])].block.get());
    const int i = order[k];
    const Node& node = g.nodes[at(i)];
    const int added = add_node(out, node.name, node.block, node.where);
    out.nodes[at(added)].declared = node.declared;
    const int count = node.end_signal - node.first_signal;
    for (int n = 0; n < count; ++n)
      signal[at(node.first_signal + n)] = out.nodes[at(added)].first_signal + n;
  }
  for (const int i : sorted_by_name(g.inputs)) {
    const Input& input = g.inputs[at(i)];
    signal[at(input.signal)] = add_input(out, input.name, input.size, input.where);
    out.inputs.back().declared = input.declared;
    out.inputs.back().parameter = input.parameter;
  }
  const auto rename = [&](std::vector<Term>& terms) {
    for (Term& t : terms) t.signal = signal[at(t.signal)];
  };
  std::vector<std::pair<int, int>> by_target;
  by_target.reserve(g.equations.size());
  for (const Equation& e : g.equations)
    by_target.emplace_back(signal[at(e.target)], static_cast<int>(by_target.size()));
  std::sort(by_target.begin(), by_target.end());
  out.equations.reserve(g.equations.size());
  for (std::size_t k = 0; k < by_target.size(); ++k) {
    if (k + 2 * kAhead < by_target.size())
      fetch(&g.equations[at(by_target[k + 2 * kAhead].second)]);
    if (k + kAhead < by_target.size())
      fetch(g.equations[at(by_target[k + kAhead].second)].terms.data());
    const auto [s, i] = by_target[k];
    Equation& e = out.equations.emplace_back(g.equations[at(i)]);
    e.target = s;
    rename(e.terms);
  }
  for (const int i : sorted_by_name(g.outputs)) {
    out.outputs.push_back(g.outputs[at(i)]);
    rename(out.outputs.back().terms);
  }
  return out;
}

Graph by_name(const Graph& graph, Stage& stage) {
  Graph sorted = by_name(graph);
  if (stage.motions.empty() && stage.before.empty()) return sorted;
  std::unordered_map<std::string_view, int> now;  // names of nodes are their own
  for (int n = 0; n < static_cast<int>(sorted.nodes.size()); ++n) now[sorted.nodes[at(n)].name] = n;
  const auto move = [&](int& node) { node = now.at(graph.nodes[at(node)].name); };
  for (RigidMotion& m : stage.motions) {
    move(m.node);
    int owner = graph.signals[at(m.signal)].node;
    const int offset = m.signal - graph.nodes[at(owner)].first_signal;
    move(owner);
    m.signal = sorted.nodes[at(owner)].first_signal + offset;
  }
  for (Dependent& d : stage.before) {
    move(d.node);
    for (Dependent::Share& s : d.of) move(s.node);
  }
  return sorted;
}

}  // namespace titop::passes
