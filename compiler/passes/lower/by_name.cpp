#include <algorithm>
#include <numeric>
#include <titop/compiler/passes/arrows.hpp>
#include <titop/compiler/passes/lower/by_name.hpp>

namespace titop::passes {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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

/// Nodes by their places in some order, and what the equations tie them to.
struct Couplings {
  std::vector<std::pair<int, int>> pairs = {};  ///< both ways
  std::vector<char> given;  ///< per node: a motion is tied to the ground, or given
  bool twice = false;       ///< some node is moved at two points

  Couplings(const Graph& g, const std::vector<int>& order) : given(order.size(), 0) {
    std::vector<int> place(order.size()), moved_at(order.size(), -1);
    for (std::size_t i = 0; i < order.size(); ++i) place[at(order[i])] = static_cast<int>(i);
    pairs.reserve(2 * g.equations.size());
    for (const Equation& e : g.equations) {
      const Signal& target = g.signals[at(e.target)];
      const int a = place[at(target.node)];
      const std::size_t before = pairs.size();
      for (const Term& t : e.terms) {
        const int node = g.signals[at(t.signal)].node;
        if (node < 0 || node == target.node) continue;
        pairs.emplace_back(a, place[at(node)]);
        pairs.emplace_back(place[at(node)], a);
      }
      if (target.quantity != Quantity::acceleration || target.channel < 0) continue;
      given[at(a)] = given[at(a)] || pairs.size() == before;
      twice = twice || (moved_at[at(a)] >= 0 && moved_at[at(a)] != e.target);
      moved_at[at(a)] = e.target;
    }
  }
};

/// By name; but where the couplings make trees, as a walk meets the nodes that goes depth first,
/// from the first names to the last: passes look from a node to its neighbours, which then lie
/// near. Where chains close, through the ground too, names alone decide, for which states stay
/// depends on this order.
std::vector<int> order_of_nodes(const Graph& g) {
  std::vector<int> by_name = sorted_by_name(g.nodes), order, open;
  const Couplings couplings(g, by_name);
  const Arrows neighbours(couplings.pairs, by_name.size());
  order.reserve(by_name.size());
  std::vector<char> met(by_name.size(), 0);
  std::size_t arrows = 0;  // of trees: two for every node but the root
  bool closed = couplings.twice;
  for (int start = 0; start < neighbours.count() && !closed; ++start) {
    if (met[at(start)]) continue;
    int given = 0;
    const std::size_t before = order.size();
    open.push_back(start);
    while (!open.empty()) {
      const int i = open.back();
      open.pop_back();
      if (met[at(i)]) continue;
      met[at(i)] = 1;
      given += couplings.given[at(i)];
      order.push_back(by_name[at(i)]);
      const auto next = neighbours.from(i);
      open.insert(open.end(), next.rbegin(), next.rend());
    }
    arrows += 2 * (order.size() - before - 1);
    closed = given > 1;
  }
  return closed || arrows < neighbours.arrows() ? by_name : order;
}

}  // namespace

Graph by_name(Graph g) {
  Graph out;
  out.name = std::move(g.name);
  out.parameters = std::move(g.parameters);
  out.nodes.reserve(g.nodes.size());
  out.channels.reserve(g.channels.size());
  out.signals.reserve(g.signals.size());
  std::vector<int> signal(g.signals.size(), -1);
  for (const int i : order_of_nodes(g)) {
    Node& node = g.nodes[at(i)];
    const int added = add_node(out, std::move(node.name), std::move(node.block), node.where);
    out.nodes[at(added)].declared = node.declared;
    const int count = node.end_signal - node.first_signal;
    for (int k = 0; k < count; ++k)
      signal[at(node.first_signal + k)] = out.nodes[at(added)].first_signal + k;
  }
  for (const int i : sorted_by_name(g.inputs)) {
    Input& input = g.inputs[at(i)];
    signal[at(input.signal)] = add_input(out, std::move(input.name), input.size, input.where);
    out.inputs.back().declared = input.declared;
  }
  const auto rename = [&](std::vector<Term>& terms) {
    for (Term& t : terms) t.signal = signal[at(t.signal)];
  };
  std::vector<std::pair<int, int>> targets;
  targets.reserve(g.equations.size());
  for (const Equation& e : g.equations)
    targets.emplace_back(signal[at(e.target)], static_cast<int>(targets.size()));
  out.equations.reserve(g.equations.size());
  const Arrows equations(targets, out.signals.size());
  for (int s = 0; s < equations.count(); ++s)
    for (const int i : equations.from(s)) {
      Equation& e = out.equations.emplace_back(std::move(g.equations[at(i)]));
      e.target = s;
      rename(e.terms);
    }
  for (const int i : sorted_by_name(g.outputs)) {
    out.outputs.push_back(std::move(g.outputs[at(i)]));
    rename(out.outputs.back().terms);
  }
  return out;
}

}  // namespace titop::passes
