#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <titop/compiler/solve/layout.hpp>
#include <titop/graph/ahead.hpp>
#include <titop/graph/declared.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/state_space.hpp>

namespace titop::detail {
namespace {

using linalg::at;

/// "u", or "U(1)" ... "U(6)".
void add_names(std::vector<std::string>& names, const std::string& name, int size) {
  for (int i = 1; i <= size; ++i)
    names.push_back(size == 1 ? name : fmt::format("{}({})", name, i));
}

/// Names in declared order; nodes are visited in their order in memory.
void add_states(const Graph& g, Layout& l) {
  std::vector<int> first(g.nodes.size() + 1, 0);
  for (std::size_t i = 0; i < g.nodes.size(); ++i) {
    const Node& node = g.nodes[i];
    fetch_ahead(g, i);
    if (node.state >= 0 && g.signals[at(node.state)].active)
      first[at(node.declared) + 1] = static_cast<int>(node.block->interface().states.size());
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  l.states.resize(at(first.back()));
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
    const Node& node = g.nodes[at(i)];
    fetch_ahead(g, at(i));
    if (node.state < 0 || !g.signals[at(node.state)].active) continue;
    const int begin = first[at(node.declared)];
    l.state_first[at(i)] = l.known_first[at(node.state)] = begin;
    l.state_nodes.push_back(i);
    std::string* name = l.states.data() + begin;
    for (const std::string& s : node.block->interface().states) *name++ = node.name + "." + s;
  }
}

}  // namespace

Layout make_layout(const Graph& g) {
  Layout l;
  l.known_first.assign(g.signals.size(), -1);
  l.state_first.assign(g.nodes.size(), -1);
  add_states(g, l);
  l.input_first.resize(g.inputs.size());
  for (const int i : as_declared(g.inputs)) {
    const Input& input = g.inputs[at(i)];
    l.input_first[at(i)] = static_cast<int>(l.inputs.size());
    l.known_first[at(input.signal)] = static_cast<int>(l.states.size() + l.inputs.size());
    add_names(l.inputs, input.name, input.size);
  }
  l.output_first.resize(g.outputs.size());
  for (const int i : as_declared(g.outputs)) {
    l.output_first[at(i)] = static_cast<int>(l.outputs.size());
    add_names(l.outputs, g.outputs[at(i)].name, g.outputs[at(i)].size);
  }
  return l;
}

std::vector<int> rates_of(const Graph& g, const Layout& l, const Eigen::MatrixXd& A) {
  std::vector<int> result(l.states.size(), -1);
  for (const int node : l.state_nodes) {
    const Interface& face = g.nodes[at(node)].block->interface();
    const int first = l.state_first[at(node)];
    for (int i = 0; i < std::ssize(face.states); ++i)
      if (const int rate = face.rate_of(i); rate >= 0)
        result[at(first + i)] = first + rate;
      else if (face.channels.empty())
        result[at(first + i)] = unit_entry(A, first + i);
  }
  return result;
}

}  // namespace titop::detail
