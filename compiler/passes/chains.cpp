#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <set>
#include <titop/compiler/passes/passes.hpp>
#include <titop/compiler/passes/union_find.hpp>

namespace titop::passes {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Points are the channels; one more vertex is the ground. Bodies are uncut edges, joints are
/// edges that may close a chain.
struct Points {
  const Graph& g;
  int ground;
  UnionFind joined;
  std::vector<std::vector<int>> tree;  ///< neighbours in the spanning forest

  explicit Points(const Graph& graph)
      : g(graph),
        ground(static_cast<int>(graph.channels.size())),
        joined(ground + 1),
        tree(graph.channels.size() + 1) {}

  bool join(int a, int b) {
    if (!joined.unite(a, b)) return false;
    tree[at(a)].push_back(b);
    tree[at(b)].push_back(a);
    return true;
  }

  std::string name(int point) const {
    return point == ground ? "the ground" : channel_name(g, point);
  }

  /// The points on the way from a to b through the forest.
  std::string way(int a, int b) const {
    std::vector<int> from(tree.size(), -1);
    std::deque<int> queue{b};
    from[at(b)] = b;
    while (!queue.empty() && from[at(a)] < 0) {
      const int p = queue.front();
      queue.pop_front();
      for (const int q : tree[at(p)])
        if (from[at(q)] < 0) from[at(q)] = p, queue.push_back(q);
    }
    std::string text = name(a);
    for (int p = a; p != b; p = from[at(p)]) text += " - " + name(from[at(p)]);
    return text;
  }
};

/// Channels of one block that move together rigidly, but for its own deformation.
void join_bodies(Points& points, ParameterValues values) {
  for (const Node& node : points.g.nodes) {
    if (node.block->interface().channels.size() < 2) continue;
    const auto k = node.block->kinematics(values);
    if (!k) continue;
    for (std::size_t i = 0; i < k->tau.size(); ++i)
      if (static_cast<int>(i) != k->reference && !k->tau[i].isZero(0))
        points.join(node.first_channel + k->reference, node.first_channel + static_cast<int>(i));
  }
}

/// Points that this equation ties its target to: other accelerations, or the ground. An
/// acceleration that an input or a controller prescribes ties to nothing.
std::set<int> tied_to(const Points& points, const Equation& e) {
  std::set<int> result;
  for (const Term& t : e.terms) {
    const Signal& s = points.g.signals[at(t.signal)];
    if (s.channel < 0 || s.quantity != Quantity::acceleration) return {};
    result.insert(s.channel);
  }
  if (e.terms.empty()) result.insert(points.ground);
  return result;
}

/// Equations that impose the motion of a point. Default directions first: what is blamed for
/// closing a chain is then its locked child point, if there is one.
std::vector<int> motions(const Graph& g) {
  std::vector<int> defaults, inverted;
  for (int e = 0; e < static_cast<int>(g.equations.size()); ++e) {
    const Signal& target = g.signals[at(g.equations[at(e)].target)];
    if (!g.equations[at(e)].active || g.equations[at(e)].of_block || target.channel < 0 ||
        target.quantity != Quantity::acceleration)
      continue;
    const auto& spec = g.nodes[at(target.node)].block->interface().channels[at(target.spec)];
    if (spec.size == 1 && spec.name.empty()) continue;  // a joint's own axis is not a point
    (spec.takes == Takes::accel ? defaults : inverted).push_back(e);
  }
  defaults.insert(defaults.end(), inverted.begin(), inverted.end());
  return defaults;
}

}  // namespace

Stage chains(Stage stage) {
  const Graph& g = stage.graph;
  Points points(g);
  join_bodies(points, stage.values);
  std::vector<Mistake> mistakes;
  std::set<std::pair<int, int>> done;  // a joint may be written in parts (.linear, .angular)
  for (const int index : motions(g)) {
    const Equation& e = g.equations[at(index)];
    const int point = g.signals[at(e.target)].channel;
    for (const int other : tied_to(points, e)) {
      if (!done.emplace(point, other).second || points.join(point, other)) continue;
      mistakes.push_back(
          {Code::kinematic_loop,
           fmt::format("{} closes a chain", name_of(g, e.target)),
           {fmt::format("{:<50} {}", print(g, e), to_string(e.where)),
            "the chain: " + points.way(point, other)},
           "closed chains are not offered yet: open one joint of the chain, or replace its last "
           "body by a spring that acts through forces"});
    }
  }
  if (!mistakes.empty()) throw Error(std::move(mistakes));
  return stage;
}

}  // namespace titop::passes
