#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <titop/compiler/passes/matching.hpp>
#include <titop/compiler/passes/union_find.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>

/// The structurally singular part, in the user's words.
namespace titop::passes {
namespace {

using linalg::at;

/// Rows that alternating paths reach from the free rows: more equations than unknowns.
std::vector<char> too_many(const Incidence& inc, const Matching& m) {
  std::vector<char> seen(at(inc.row_vertices()), 0);
  std::vector<int> rows;
  for (int r = 0; r < inc.row_vertices(); ++r)
    if (m.row_to_col[at(r)] < 0) seen[at(r)] = 1, rows.push_back(r);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const int c : inc.cols(rows[i]))
      if (const int r = m.col_to_row[at(c)]; r >= 0 && !seen[at(r)])
        seen[at(r)] = 1, rows.push_back(r);
  return seen;
}

/// Columns that alternating paths reach from the free columns: more unknowns than equations.
std::vector<char> too_few(const Incidence& inc, const Matching& m) {
  std::vector<std::vector<int>> rows_of_col(inc.signal_of.size());
  for (int r = 0; r < inc.row_vertices(); ++r)
    for (const int c : inc.cols(r)) rows_of_col[at(c)].push_back(r);
  std::vector<char> seen(inc.signal_of.size(), 0);
  std::vector<int> cols;
  for (int c = 0; c < static_cast<int>(inc.signal_of.size()); ++c)
    if (m.col_to_row[at(c)] < 0) seen[at(c)] = 1, cols.push_back(c);
  for (std::size_t i = 0; i < cols.size(); ++i)
    for (const int r : rows_of_col[at(cols[i])])
      if (const int c = m.row_to_col[at(r)]; c >= 0 && !seen[at(c)])
        seen[at(c)] = 1, cols.push_back(c);
  return seen;
}

/// For the first line: all of them stand below it, one by one.
std::string joined(const std::set<std::string>& names) {
  return detail::some_names(std::vector<std::string>(names.begin(), names.end()));
}

/// One independent part: equations too many, signals that nothing determines, or both.
struct SingularPart {
  std::set<int> rows, signals;    ///< row groups; signals
  std::vector<int> cures;         ///< equations whose channel may be driven on its other side
  int too_many = 0, too_few = 0;  ///< scalars
};

struct Singular {
  const Graph& g;
  const Incidence& inc;
  const Matching& m;
  std::vector<char> over = too_many(inc, m), under = too_few(inc, m);
  int rows = inc.row_vertices();
  UnionFind parts = UnionFind(rows + static_cast<int>(inc.signal_of.size()));

  int other_side(int equation) const {
    const int target = g.equations[at(equation)].target;
    if (g.signals[at(target)].channel < 0) return -1;
    const Channel& c = g.channels[at(g.signals[at(target)].channel)];
    return c.accel == target ? c.force : c.accel;
  }

  /// True if driving the channel's other side instead leaves fewer signals undetermined.
  bool cures(int equation) const {
    Graph other = g;
    other.equations[at(equation)].target = other_side(equation);
    other.equations[at(equation)].terms.clear();
    const Incidence i = incidence(other, /*by_scalar=*/true, Sight::through_states);
    return maximum_matching(other, i).missing() < m.missing();
  }

  /// Joins connected equations and signals, and those that another side of a channel would connect.
  std::vector<int> connect() {
    for (int r = 0; r < rows; ++r)
      for (const int c : inc.cols(r))
        if (over[at(r)] || under[at(c)]) parts.unite(r, rows + c);
    std::set<int> equations;
    for (int r = 0; r < rows; ++r)
      if (const int e = inc.rows[at(inc.row_of_vertex[at(r)])].equation; over[at(r)] && e >= 0)
        equations.insert(e);
    std::vector<int> good;
    for (const int e : equations) {
      const int side = other_side(e);
      if (side < 0 || inc.first_col[at(side)] < 0 || !cures(e)) continue;
      good.push_back(e);
      for (int r = 0; r < rows; ++r)
        if (inc.rows[at(inc.row_of_vertex[at(r)])].equation == e)
          for (int k = 0; k < g.signals[at(side)].size; ++k)
            parts.unite(r, rows + inc.first_col[at(side)] + k);
    }
    return good;
  }

  std::map<int, SingularPart> find() {
    const std::vector<int> good = connect();
    std::map<int, SingularPart> result;
    for (int r = 0; r < rows; ++r) {
      if (!over[at(r)]) continue;
      SingularPart& p = result[parts.find(r)];
      const int row = inc.row_of_vertex[at(r)];
      p.rows.insert(row);
      p.too_many += m.row_to_col[at(r)] < 0;
      const int e = inc.rows[at(row)].equation;
      if (std::find(good.begin(), good.end(), e) != good.end() &&
          std::find(p.cures.begin(), p.cures.end(), e) == p.cures.end())
        p.cures.push_back(e);
    }
    for (int c = 0; c < static_cast<int>(under.size()); ++c) {
      if (!under[at(c)]) continue;
      SingularPart& p = result[parts.find(rows + c)];
      p.signals.insert(inc.signal_of[at(c)]);
      p.too_few += m.col_to_row[at(c)] < 0;
    }
    return result;
  }

  /// True if the equation sets a motion or a force and joins no points: it is a more likely mistake
  /// than the mounts of bodies.
  bool imposes(int equation) const {
    const std::vector<Term>& terms = g.equations[at(equation)].terms;
    return std::none_of(terms.begin(), terms.end(), [&](const Term& t) {
      return t.signal >= 0 && g.signals[at(t.signal)].channel >= 0;
    });
  }

  std::string describe(const Row& row) const {
    if (row.equation < 0)
      return fmt::format("output {} of {}", name_of(g, row.output), g.nodes[at(row.node)].name);
    const Equation& e = g.equations[at(row.equation)];
    return fmt::format("{:<50} {}", print(g, e), to_string(e.where));
  }

  Mistake mistake(const SingularPart& p) const {
    Mistake result{Code::structure, "every channel is driven, but ", {}, {}};
    std::set<std::string> here, there, sides;
    for (const int r : p.rows) {
      const Row& row = inc.rows[at(r)];
      here.insert(name_of(g, row.equation < 0 ? row.output : g.equations[at(row.equation)].target));
      result.details.push_back("surplus equation:  " + describe(row));
    }
    for (const int s : p.signals) {
      there.insert(name_of(g, s));
      result.details.push_back("undetermined:  " + name_of(g, s));
    }
    if (p.too_many > 0)
      result.message += p.too_many == 1
                            ? "one surplus equation at " + joined(here)
                            : fmt::format("{} surplus equations at {}", p.too_many, joined(here));
    if (p.too_few > 0)
      result.message +=
          fmt::format("{}{} missing at {}", p.too_many > 0 ? "; " : "",
                      p.too_few == 1 ? "one is" : fmt::format("{} are", p.too_few), joined(there));
    const bool imposed =
        std::any_of(p.cures.begin(), p.cures.end(), [&](int e) { return imposes(e); });
    for (const int e : p.cures)
      if (imposes(e) || !imposed)
        sides.insert(fmt::format("{} instead of {}", name_of(g, other_side(e)),
                                 name_of(g, g.equations[at(e)].target)));
    result.hint = sides.empty() ? "remove one of these equations, or add a joint or modes between "
                                  "their blocks"
                                : "drive the other side of one of these channels: " + joined(sides);
    return result;
  }
};

}  // namespace

std::vector<Mistake> structure_mistakes(const Graph& g, const Incidence& inc, const Matching& m) {
  Singular singular{g, inc, m};
  std::vector<Mistake> result;
  for (const auto& [root, part] : singular.find()) result.push_back(singular.mistake(part));
  return result;
}

}  // namespace titop::passes
