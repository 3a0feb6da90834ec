#include <algorithm>
#include <numeric>
#include <titop/compiler/passes/lower/by_name.hpp>

namespace titop::passes {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

template <class List>
std::vector<int> sorted_by_name(const List& list) {
  std::vector<int> order(list.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return natural_compare(list[at(a)].name, list[at(b)].name) < 0; });
  return order;
}

}  // namespace

Graph by_name(const Graph& g) {
  Graph out;
  out.name = g.name;
  out.parameters = g.parameters;
  std::vector<int> signal(g.signals.size(), -1);
  for (const int i : sorted_by_name(g.nodes)) {
    const Node& node = g.nodes[at(i)];
    const int added = add_node(out, node.name, node.block, node.where);
    out.nodes[at(added)].declared = node.declared;
    const int count = end_signal(g, i) - node.first_signal;
    for (int k = 0; k < count; ++k)
      signal[at(node.first_signal + k)] = out.nodes[at(added)].first_signal + k;
  }
  for (const int i : sorted_by_name(g.inputs)) {
    const Input& input = g.inputs[at(i)];
    signal[at(input.signal)] = add_input(out, input.name, input.size, input.where);
    out.inputs.back().declared = input.declared;
  }
  const auto renamed = [&](std::vector<Term> terms) {
    for (Term& t : terms) t.signal = signal[at(t.signal)];
    return terms;
  };
  for (const Equation& e : g.equations) {
    out.equations.push_back(e);
    out.equations.back().target = signal[at(e.target)];
    out.equations.back().terms = renamed(e.terms);
  }
  for (const int i : sorted_by_name(g.outputs)) {
    out.outputs.push_back(g.outputs[at(i)]);
    out.outputs.back().terms = renamed(g.outputs[at(i)].terms);
  }
  return out;
}

}  // namespace titop::passes
