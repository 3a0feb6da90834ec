#include <algorithm>
#include <titop/compiler/passes/matching.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::passes {
namespace {

using linalg::at;

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

/// Augmenting paths, breadth first. The cost of many free rows, each with a free column nearby, is
/// that of their neighbourhoods.
class Augmenting {
 public:
  Augmenting(const Incidence& inc, Matching& m)
      : inc_(inc), m_(m), from_(m.col_to_row.size(), -1) {}

  /// One path from a free row, if there is one. If there is none, no later path leads through the
  /// visited vertices: they remain marked.
  void from(int start) {
    rows_.assign(1, start);
    found_.clear();
    for (std::size_t next = 0; next < rows_.size(); ++next)
      if (const int free = look_from(rows_[next]); free >= 0) {
        flip(free, start);
        for (const int col : found_) from_[at(col)] = -1;
        return;
      }
  }

 private:
  /// A free column of this row, or -1: then the rows of all its other columns are to be looked at.
  int look_from(int row) {
    for (const int col : inc_.cols(row)) {
      if (from_[at(col)] >= 0 || !fits(inc_, row, col)) continue;
      from_[at(col)] = row;
      found_.push_back(col);
      if (m_.col_to_row[at(col)] < 0) return col;
      rows_.push_back(m_.col_to_row[at(col)]);
    }
    return -1;
  }
  /// The path that ends in this column, back to its start: every row gets the column found by it.
  void flip(int col, int start) {
    for (int c = col; c >= 0;) {
      const int row = from_[at(c)], before = m_.row_to_col[at(row)];
      m_.row_to_col[at(row)] = c;
      m_.col_to_row[at(c)] = row;
      c = row == start ? -1 : before;
    }
  }

  const Incidence& inc_;
  Matching& m_;
  std::vector<int> from_;          ///< column -> row that found it
  std::vector<int> rows_, found_;  ///< of the present path: to be looked at; columns found
};

}  // namespace

int Matching::missing() const {
  return static_cast<int>(std::count(row_to_col.begin(), row_to_col.end(), -1) +
                          std::count(col_to_row.begin(), col_to_row.end(), -1));
}

Matching maximum_matching(const Graph& g, const Incidence& inc) {
  Matching m{std::vector<int>(at(inc.row_vertices()), -1),
             std::vector<int>(inc.signal_of.size(), -1)};
  take_defaults(g, inc, m);
  Augmenting path(inc, m);
  for (int r = 0; r < inc.row_vertices(); ++r)
    if (m.row_to_col[at(r)] < 0) path.from(r);
  return m;
}

}  // namespace titop::passes
