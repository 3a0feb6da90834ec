#include <algorithm>
#include <titop/analysis/reduction/remove_signals.hpp>
#include <titop/emit/report/written.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::report {
namespace {

using linalg::at;

/// Takes these nodes, which have no channels and no signals any more; the others move up.
void remove_nodes(Graph& g, const std::vector<char>& gone) {
  std::vector<int> place(g.nodes.size(), -1);
  std::vector<Node> kept;
  for (std::size_t n = 0; n < g.nodes.size(); ++n) {
    if (gone[n]) continue;
    place[n] = static_cast<int>(kept.size());
    kept.push_back(std::move(g.nodes[n]));
  }
  g.nodes = std::move(kept);
  for (Channel& c : g.channels) c.node = place[at(c.node)];
  for (Signal& s : g.signals) {
    if (s.node >= 0) s.node = place[at(s.node)];
    if (s.frame >= 0) s.frame = place[at(s.frame)];
  }
}

}  // namespace

Graph written(const Stage& stage) {
  Graph g = stage.written();
  std::vector<char> nodes(g.nodes.size(), 0), signals(g.signals.size(), 0);
  for (const RigidMotion& m : stage.motions) {
    const Node& integrator = g.nodes[at(m.node)];
    nodes[at(m.node)] = 1;
    for (int s = integrator.first_signal; s < integrator.end_signal; ++s) signals[at(s)] = 1;
  }
  std::erase_if(g.equations, [&](const Equation& e) { return signals[at(e.target)] != 0; });
  detail::remove_signals(g, signals);
  remove_nodes(g, nodes);
  return g;
}

}  // namespace titop::report
