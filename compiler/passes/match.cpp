#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <set>
#include <titop/compiler/passes/incidence.hpp>
#include <titop/compiler/passes/passes.hpp>

namespace titop::passes {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct Matching {
  std::vector<int> row_to_col, col_to_row;
  bool perfect() const {
    return std::find(row_to_col.begin(), row_to_col.end(), -1) == row_to_col.end();
  }
};

bool fits(const Incidence& inc, int row, int col) {
  return inc.row_size[at(row)] == inc.col_size[at(col)];
}

/// The defaults: a block row determines its own output, an equation its target.
void take_defaults(const Graph& g, const Incidence& inc, Matching& m) {
  for (int r = 0; r < static_cast<int>(inc.rows.size()); ++r) {
    const Row& row = inc.rows[at(r)];
    const int signal = row.equation >= 0 ? g.equations[at(row.equation)].target : row.output;
    const int end = r + 1 < static_cast<int>(inc.rows.size()) ? inc.first_row[at(r + 1)]
                                                              : static_cast<int>(inc.cols.size());
    for (int v = inc.first_row[at(r)]; v < end; ++v)
      for (const int c : inc.cols[at(v)]) {
        if (inc.signal_of[at(c)] != signal || m.col_to_row[at(c)] >= 0 || !fits(inc, v, c))
          continue;
        // Scalars of a whole signal stand in the same order on both sides.
        if (inc.first_col[at(signal)] + (v - inc.first_row[at(r)]) != c && row.equation < 0)
          continue;
        m.row_to_col[at(v)] = c;
        m.col_to_row[at(c)] = v;
        break;
      }
  }
}

/// One augmenting path from a free row, breadth first. False if there is none.
bool augment(const Incidence& inc, Matching& m, int start) {
  std::vector<int> from(m.col_to_row.size(), -1);  // column -> row that found it
  std::deque<int> queue{start};
  while (!queue.empty()) {
    const int row = queue.front();
    queue.pop_front();
    for (const int col : inc.cols[at(row)]) {
      if (from[at(col)] >= 0 || !fits(inc, row, col)) continue;
      from[at(col)] = row;
      if (m.col_to_row[at(col)] >= 0) {
        queue.push_back(m.col_to_row[at(col)]);
        continue;
      }
      for (int c = col; c >= 0;) {  // flip the path back to its start
        const int r = from[at(c)];
        const int next = m.row_to_col[at(r)];
        m.row_to_col[at(r)] = c;
        m.col_to_row[at(c)] = r;
        c = r == start ? -1 : next;
      }
      return true;
    }
  }
  return false;
}

Matching maximum_matching(const Graph& g, const Incidence& inc) {
  Matching m{std::vector<int>(inc.cols.size(), -1), std::vector<int>(inc.signal_of.size(), -1)};
  take_defaults(g, inc, m);
  for (int r = 0; r < static_cast<int>(inc.cols.size()); ++r)
    if (m.row_to_col[at(r)] < 0) augment(inc, m, r);
  return m;
}

// --- the structurally singular part, in the user's words ----------------------------------------

/// Rows that alternating paths reach from the free rows: more equations than unknowns.
std::vector<int> overdetermined(const Incidence& inc, const Matching& m) {
  std::vector<char> seen(inc.cols.size(), 0);
  std::vector<int> rows;
  for (int r = 0; r < static_cast<int>(inc.cols.size()); ++r)
    if (m.row_to_col[at(r)] < 0) seen[at(r)] = 1, rows.push_back(r);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const int c : inc.cols[at(rows[i])])
      if (const int r = m.col_to_row[at(c)]; r >= 0 && !seen[at(r)])
        seen[at(r)] = 1, rows.push_back(r);
  std::sort(rows.begin(), rows.end());
  return rows;
}

/// Columns that alternating paths reach from the free columns: more unknowns than equations.
std::vector<int> underdetermined(const Incidence& inc, const Matching& m) {
  std::vector<std::vector<int>> rows_of_col(inc.signal_of.size());
  for (int r = 0; r < static_cast<int>(inc.cols.size()); ++r)
    for (const int c : inc.cols[at(r)]) rows_of_col[at(c)].push_back(r);
  std::vector<char> seen(inc.signal_of.size(), 0);
  std::vector<int> cols;
  for (int c = 0; c < static_cast<int>(inc.signal_of.size()); ++c)
    if (m.col_to_row[at(c)] < 0) seen[at(c)] = 1, cols.push_back(c);
  for (std::size_t i = 0; i < cols.size(); ++i)
    for (const int r : rows_of_col[at(cols[i])])
      if (const int c = m.row_to_col[at(r)]; c >= 0 && !seen[at(c)])
        seen[at(c)] = 1, cols.push_back(c);
  std::sort(cols.begin(), cols.end());
  return cols;
}

std::string describe(const Graph& g, const Row& row) {
  if (row.equation < 0)
    return fmt::format("what {} gives at {}", g.nodes[at(row.node)].name, name_of(g, row.output));
  const Equation& e = g.equations[at(row.equation)];
  return fmt::format("{}   ({})", print(g, e), to_string(e.where));
}

Mistake structure_mistake(const Graph& g, const Incidence& inc, const Matching& m) {
  Mistake mistake{Code::structure, {}, {}, {}};
  std::set<int> rows, signals;
  for (const int r : overdetermined(inc, m)) rows.insert(inc.row_of_vertex[at(r)]);
  for (const int c : underdetermined(inc, m)) signals.insert(inc.signal_of[at(c)]);
  std::string first = "the diagram", candidates, undetermined;
  for (const int r : rows) {
    const Row& row = inc.rows[at(r)];
    if (row.equation >= 0 && candidates.empty())
      first = name_of(g, g.equations[at(row.equation)].target);
    if (row.equation >= 0)
      candidates +=
          (candidates.empty() ? "" : ", ") + name_of(g, g.equations[at(row.equation)].target);
    mistake.details.push_back("too much here:  " + describe(g, row));
  }
  for (const int s : signals) {
    undetermined += (undetermined.empty() ? "" : ", ") + name_of(g, s);
    mistake.details.push_back("nothing determines:  " + name_of(g, s));
  }
  mistake.message =
      fmt::format("every channel is driven, but {} is determined twice and {} by nothing", first,
                  undetermined.empty() ? "another signal" : undetermined);
  mistake.hint = fmt::format("drive the other side of one of these channels: {}",
                             candidates.empty() ? undetermined : candidates);
  return mistake;
}

// --- inversions ----------------------------------------------------------------------------------

/// A channel is inverted where an equation determines the signal that its block gives by default.
/// (What the matching or the pivots turn round inside a loop, between blocks, is their own affair.)
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
  Incidence inc = incidence(stage.graph, /*by_scalar=*/false);
  Matching m = maximum_matching(stage.graph, inc);
  if (!m.perfect()) {
    inc = incidence(stage.graph, /*by_scalar=*/true);
    m = maximum_matching(stage.graph, inc);
  }
  if (!m.perfect() || inc.cols.size() != inc.signal_of.size())
    throw Error(structure_mistake(stage.graph, inc, m));
  stage.rows = inc.rows;
  find_inversions(stage);
  stage.matched.rows.clear();
  for (std::size_t r = 0; r < m.row_to_col.size(); ++r)
    stage.matched.rows.push_back({inc.row_of_vertex[r], inc.signal_of[at(m.row_to_col[r])]});
  return stage;
}

}  // namespace titop::passes
