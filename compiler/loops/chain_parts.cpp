#include <titop/compiler/loops/chain_parts.hpp>
#include <titop/compiler/loops/motion.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::loops {

ChainParts parts_of_chains(const Stage& stage) {
  const Graph& g = stage.graph;
  const SumExpander sums(g);
  const Motion motion(g, stage.values, sums, Ground::by_name, stage.released);
  ChainParts parts;
  for (const Tie& tie : motion.ties()) {
    if (!tie.closes) continue;
    const Closing c = motion.closing(tie);
    parts.equations.insert(parts.equations.end(), c.equations.begin(), c.equations.end());
    for (const int point : c.chain)
      if (linalg::at(point) < g.channels.size())  // not the ground
        parts.nodes.push_back(g.channels[linalg::at(point)].node);
  }
  detail::keep_each_once(parts.equations), detail::keep_each_once(parts.nodes);
  return parts;
}

}  // namespace titop::loops
