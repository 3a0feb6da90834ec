#include <titop/compiler/passes/arrows.hpp>
#include <titop/compiler/passes/lower/along_trees.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::passes {
namespace {

using linalg::at;

/// Nodes by their places in some order, and the nodes to which equations tie them.
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

}  // namespace

std::vector<int> along_trees(const Graph& g, std::vector<int> given_order) {
  const Couplings couplings(g, given_order);
  const Arrows neighbours(couplings.pairs, given_order.size());
  std::vector<int> order, open;
  order.reserve(given_order.size());
  std::vector<char> met(given_order.size(), 0);
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
      order.push_back(given_order[at(i)]);
      const auto next = neighbours.from(i);
      open.insert(open.end(), next.rbegin(), next.rend());
    }
    arrows += 2 * (order.size() - before - 1);
    closed = given > 1;
  }
  return closed || arrows < neighbours.arrows() ? given_order : order;
}

}  // namespace titop::passes
