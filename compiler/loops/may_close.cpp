#include <algorithm>
#include <titop/compiler/loops/may_close.hpp>
#include <titop/compiler/passes/union_find.hpp>
#include <titop/graph/ahead.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::loops {
namespace {

using linalg::at;

/// Points and the ground, joined by bodies and ties.
struct Joined {
  const Graph& g;
  passes::UnionFind joined = passes::UnionFind(static_cast<int>(g.channels.size()) + 1);
  int ground = static_cast<int>(g.channels.size());

  void bodies(ParameterValues values) {
    const Block* met = nullptr;  // nodes that share a block often stand side by side
    std::optional<Kinematics> k;
    std::size_t turn = 0;
    for (const Node& node : g.nodes) {
      fetch_ahead(g, turn++);
      const auto& channels = node.block->interface().channels;
      if (channels.empty()) continue;
      if (node.block.get() != met)
        k = channels.size() < 2 ? std::nullopt : node.block->kinematics(values);
      met = node.block.get();
      for (int i = 1; i < static_cast<int>(channels.size()); ++i)
        if (!k) joined.unite(node.first_channel, node.first_channel + i);
      for (int i = 0; k && i < static_cast<int>(channels.size()); ++i)
        if (i != k->reference)
          joined.unite(node.first_channel + i,
                       k->tau[at(i)].isZero(0) ? ground : node.first_channel + k->reference);
    }
  }

  bool tied_twice(const Equation& e) {
    const Signal& target = g.signals[at(e.target)];
    if (!e.active || e.of_block || target.channel < 0 || target.quantity != Quantity::acceleration)
      return false;
    bool points = false;
    for (const Term& t : e.terms) {
      const Signal& s = g.signals[at(t.signal)];
      if (s.channel < 0 && s.node >= 0 && g.nodes[at(s.node)].lowered) return true;
      if (s.channel < 0 || s.quantity != Quantity::acceleration) continue;
      points = true;
      if (!joined.unite(target.channel, s.channel)) return true;
    }
    return !points && !joined.unite(target.channel, ground);
  }

  bool closes(ParameterValues values) {
    std::size_t turn = 0;
    for (const Node& node : g.nodes) {
      fetch_ahead(g, turn++);
      if (node.block->type() == "Integrator") return true;
    }
    bodies(values);
    return std::any_of(g.equations.begin(), g.equations.end(),
                       [&](const Equation& e) { return tied_twice(e); });
  }
};

}  // namespace

bool may_close(const Graph& graph, ParameterValues values) { return Joined{graph}.closes(values); }

}  // namespace titop::loops
