#include <titop/compiler/passes/matching.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/linalg/index.hpp>
#include <utility>

namespace titop::passes {
namespace {

using linalg::at;

/// Coarse to fine. Signals that are only determined through states (a massless point between
/// springs) lead to a singular state space at first, which `reduce` makes regular.
constexpr std::pair<bool, Sight> kSights[] = {{false, Sight::at_once},
                                              {true, Sight::at_once},
                                              {false, Sight::through_states},
                                              {true, Sight::through_states}};

/// A channel is inverted if an equation determines the signal that its block outputs by default.
/// (Inversions by matching or pivoting inside a loop, between blocks, do not count.)
void find_inversions(Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<char> imposed(g.signals.size(), 0);
  for (const Equation& e : g.equations)
    if (e.active && !e.of_block) imposed[at(e.target)] = 1;
  for (int i = 0; i < static_cast<int>(g.channels.size()); ++i) {
    const Channel& channel = g.channels[at(i)];
    if (imposed[at(channel.takes == Takes::force ? channel.accel : channel.force)])
      stage.inversions.push_back({i, /*forced=*/true});
  }
}

}  // namespace

Stage match(Stage stage) {
  Incidence inc;
  Matching m;
  for (const auto& [by_scalar, sight] : kSights) {
    inc = incidence(stage.graph, by_scalar, sight);
    m = maximum_matching(stage.graph, inc);
    if (m.missing() == 0) break;
  }
  if (m.missing() > 0) throw Error(structure_mistakes(stage.graph, inc, m));
  stage.rows = inc.rows;
  find_inversions(stage);
  stage.matched.rows.clear();
  for (std::size_t r = 0; r < m.row_to_col.size(); ++r)
    stage.matched.rows.push_back({inc.row_of_vertex[r], inc.signal_of[at(m.row_to_col[r])]});
  return stage;
}

}  // namespace titop::passes
