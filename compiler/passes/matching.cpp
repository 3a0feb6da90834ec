#include <algorithm>
#include <deque>
#include <titop/compiler/passes/matching.hpp>

namespace titop::passes {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

bool fits(const Incidence& inc, int row, int col) {
  return inc.row_size[at(row)] == inc.col_size[at(col)];
}

/// The defaults: a block row determines its own output, an equation its target.
void take_defaults(const Graph& g, const Incidence& inc, Matching& m) {
  for (int r = 0; r < static_cast<int>(inc.rows.size()); ++r) {
    const Row& row = inc.rows[at(r)];
    const int signal = row.equation >= 0 ? g.equations[at(row.equation)].target : row.output;
    const int end =
        r + 1 < static_cast<int>(inc.rows.size()) ? inc.first_row[at(r + 1)] : inc.row_vertices();
    for (int v = inc.first_row[at(r)]; v < end; ++v)
      for (const int c : inc.cols(v)) {
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
    for (const int col : inc.cols(row)) {
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

}  // namespace

int Matching::missing() const {
  return static_cast<int>(std::count(row_to_col.begin(), row_to_col.end(), -1) +
                          std::count(col_to_row.begin(), col_to_row.end(), -1));
}

Matching maximum_matching(const Graph& g, const Incidence& inc) {
  Matching m{std::vector<int>(at(inc.row_vertices()), -1),
             std::vector<int>(inc.signal_of.size(), -1)};
  take_defaults(g, inc, m);
  for (int r = 0; r < inc.row_vertices(); ++r)
    if (m.row_to_col[at(r)] < 0) augment(inc, m, r);
  return m;
}

}  // namespace titop::passes
