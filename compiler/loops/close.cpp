#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <titop/compiler/loops/integrals.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::passes {
namespace {

using Eigen::Index;
using namespace loops;
using linalg::at;

/// One of the two levels on which chains close.
enum class ClosureLevel { position, velocity };

/// A rank decided by a narrow margin.
struct Doubt {
  std::string joints;
  double pivot = 0;
  bool taken = false;  ///< as a constraint; the other decision would keep two more states
};

struct Closer {
  const Graph& g;
  const StateRates& coordinates;
  std::vector<Doubt> doubts = {};
  std::vector<Dependent> dependents = {};
  std::set<std::pair<int, int>> before = {};  ///< states that followed from the others before
  int closings = 0;  ///< of all lines on either level, so many come first: those of chains
  std::vector<ScalarColumn> positions = {};  ///< dependent on position level, in order
  std::map<std::vector<int>, Independent> of_positions = {};  ///< by lines, all of them of chains

  std::optional<loops::ColumnRole> classify(const ScalarColumn& s) const {
    using Role = Relations::Role;
    if (s.column.kind == FormColumn::Kind::integral) return loops::ColumnRole{Role::integral, 0};
    if (s.column.kind != FormColumn::Kind::states) return loops::ColumnRole{Role::unknown, 0};
    const Signal& x = g.signals[at(g.nodes[at(s.column.id)].state)];
    if (x.at_rest) return std::nullopt;
    if (!x.active) return loops::ColumnRole{Role::unknown, 0};
    return loops::ColumnRole{Role::coordinate, coordinates.weight(s.column.id, s.index)};
  }

  /// The state of this scalar on this level.
  std::pair<int, int> state(const ScalarColumn& s, ClosureLevel level) const {
    const bool own = s.column.kind == FormColumn::Kind::integral || level == ClosureLevel::position;
    return {s.column.id, own ? s.index : coordinates.rate_of(s.column.id, s.index)};
  }

  /// Columns that followed before, and coordinates whose positions follow.
  std::vector<int> preferred(const Component& c, ClosureLevel level) const {
    std::vector<int> list;
    for (int i = 0; i < static_cast<int>(c.scalars.size()); ++i)
      if (std::binary_search(positions.begin(), positions.end(), c.scalars[at(i)]) ||
          (c.relations.role[at(i)] != Relations::Role::unknown &&
           before.contains(state(c.scalars[at(i)], level))))
        list.push_back(i);
    return list;
  }

  void close(const std::vector<RelationRows>& lines, ClosureLevel level) {
    const auto meaning = [&](const ScalarColumn& s) { return classify(s); };
    std::vector<ScalarColumn> now;
    for (Component& c : components(lines, meaning)) {
      const auto same = of_positions.find(c.lines);
      const std::vector<int> first = preferred(c, level);  // before the relations move on
      const Independent found =
          same != of_positions.end()
              ? same->second  // rates follow as positions do, coordinate by coordinate
              : independent(std::move(c.relations), first);
      if (level == ClosureLevel::position && c.lines.back() < closings)
        of_positions.emplace(c.lines, found);
      warn(c, lines, found, level);
      for (const Independent::Follows& f : found.follow) {
        const ScalarColumn& s = c.scalars[at(f.dependent)];
        const auto [node, index] = state(s, level);
        Dependent dependent{node, index};
        for (std::size_t k = 0; k < f.of.size(); ++k) {
          const auto [of, at_index] = state(c.scalars[at(f.of[k].first)], level);
          dependent.of.push_back({of, at_index, f.of[k].second, f.rounding[k]});
        }
        dependents.push_back(std::move(dependent));
        if (level == ClosureLevel::position) now.push_back(s);
      }
    }
    positions = std::move(now);
    std::sort(positions.begin(), positions.end());
  }

  void warn(const Component& c, const std::vector<RelationRows>& lines, const Independent& found,
            ClosureLevel level) {
    if (!found.doubtful() || level != ClosureLevel::position) return;
    std::string names;
    for (const int l : c.lines)
      if (const int e = lines[at(l)].equation; e >= 0)
        names += (names.empty() ? "" : ", ") + name_of(g, g.equations[at(e)].target);
    const bool taken = found.weakest < kNarrow;
    doubts.push_back({std::move(names), taken ? found.weakest : found.dropped, taken});
  }
};

std::string list(const Graph& g, std::vector<Dependent> dependents) {
  std::sort(dependents.begin(), dependents.end(), [](const auto& a, const auto& b) {
    return std::pair(a.node, a.state) < std::pair(b.node, b.state);
  });
  std::vector<std::string> names;
  for (const Dependent& d : dependents) {
    const Node& node = g.nodes[at(d.node)];
    names.push_back(node.name + "." + node.block->interface().states[at(d.state)]);
  }
  return detail::some_names(names);
}

}  // namespace

Stage close(Stage stage) {
  if (!stage.closes) return stage;
  const Graph& g = stage.graph;
  const SumExpander sums(g);
  const Motion motion(g, stage.values, sums, Ground::by_name, stage.released);
  const StateRates coordinates(g, stage.values);
  std::vector<RelationRows> closed, on_positions, on_rates;
  for (const Tie& tie : motion.ties())
    if (tie.closes) closed.push_back(line_of(motion.closing(tie)));
  on_positions = on_rates = closed;
  for (const Integral& i : integrals(g, motion, sums, coordinates, stage.values)) {
    const int n = g.signals[at(g.nodes[at(i.node)].state)].size;
    RelationRows line;
    add(line.form, -Eigen::MatrixXd::Identity(n, n), i.form);
    add(line.form, {FormColumn::Kind::integral, i.node}, Eigen::MatrixXd::Identity(n, n));
    for (int k = 0; k < n; ++k) line.unit.push_back(n == 6 && k >= 3 ? 1 : 0);
    (i.level == 1 ? on_rates : on_positions).push_back(std::move(line));
  }
  Closer closer{g, coordinates};
  closer.closings = static_cast<int>(closed.size());
  for (const Dependent& d : stage.before) closer.before.emplace(d.node, d.state);
  closer.close(on_positions, ClosureLevel::position);
  closer.close(on_rates, ClosureLevel::velocity);
  stage.dependents = std::move(closer.dependents);
  int order = -static_cast<int>(stage.dependents.size());
  for (const Signal& x : g.signals)
    if (x.role == Signal::Role::state && x.active) order += x.size;
  for (const Doubt& d : closer.doubts)
    stage.notes.push_back(
        {Note::Kind::warning, "close",
         fmt::format("the chain closed by {} is near a singular posture (pivot {:.1e}, tolerance "
                     "{:.0e}): order {}, or {} if that were taken for {}",
                     d.joints, d.pivot, kMatrixDigits, order, d.taken ? order + 2 : order - 2,
                     d.taken ? "nothing" : "a constraint")});
  if (!stage.dependents.empty())
    stage.notes.push_back({Note::Kind::info, "close",
                           fmt::format("{} states follow from the others: {}",
                                       stage.dependents.size(), list(g, stage.dependents))});
  return stage;
}

}  // namespace titop::passes
