#include <titop/compiler/passes/incidence.hpp>
#include <titop/graph/ahead.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::passes {
namespace {

using linalg::at;

}  // namespace

std::vector<Row> rows_of(const Graph& g) {
  std::vector<Row> rows;
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
    if (g.nodes[at(i)].lowered) continue;
    for (int o = g.nodes[at(i)].first_signal; o < end_signal(g, i); ++o) {
      const Signal& y = g.signals[at(o)];
      if (y.role == Signal::Role::output && y.row) rows.push_back({i, o, -1, y.size});
    }
  }
  for (int e = 0; e < static_cast<int>(g.equations.size()); ++e) {
    const Equation& equation = g.equations[at(e)];
    const Signal& target = g.signals[at(equation.target)];
    if (equation.active)
      rows.push_back(
          {-1, -1, e,
           equation.part.whole() ? target.size : static_cast<int>(equation.part.rows().rows())});
  }
  return rows;
}

namespace {

Pattern identity(int n) { return Eigen::MatrixXd::Identity(n, n).array() != 0; }

/// Rows that see the states (a column) times inputs that move them.
Pattern through(const Pattern& sees, const Pattern& moved) {
  return (sees.cast<int>().matrix() * moved.cast<int>().matrix()).array() > 0;
}

/// Declared structure of a node.
struct Declared {
  Pattern direct;  ///< D or, through its states, all that the inputs move in time
  Pattern moved;   ///< which inputs move the states; empty if states do not count
};

std::vector<Declared> all_declared(const Graph& g, Sight sight) {
  std::vector<Declared> result;
  for (const Node& node : g.nodes) {
    fetch_ahead(g, result.size());
    result.emplace_back();
    if (node.lowered) continue;
    result.back().direct = node.block->feedthrough();
    if (sight == Sight::at_once || node.state < 0 || !g.signals[at(node.state)].active) continue;
    result.back().moved = node.block->moved_by();
    result.back().direct =
        result.back().direct || through(node.block->seen_by(), result.back().moved);
  }
  return result;
}

/// The inputs of a node whose states an equation reads in these rows.
template <class Visit>
void visit_inputs(const Graph& g, int node, const Pattern& sees, const Pattern& moved,
                  Visit visit) {
  for (int i = g.nodes[at(node)].first_signal; i < end_signal(g, node); ++i) {
    const Signal& u = g.signals[at(i)];
    if (u.role != Signal::Role::input || !u.active) continue;
    if (const Pattern p = through(sees, moved.middleCols(u.first, u.size)); p.any())
      visit(i, [&] { return p; });
  }
}

/// Calls visit(signal, pattern) for every unknown of a row; pattern() gives its structure.
template <class Visit>
void visit_entries(const Graph& g, const Row& row, const std::vector<Declared>& declared,
                   Visit visit) {
  if (row.equation >= 0) {
    const Equation& e = g.equations[at(row.equation)];
    const Signal& t = g.signals[at(e.target)];
    if (is_unknown(t))
      visit(e.target, [&] {
        return e.part.whole() ? identity(t.size) : Pattern(e.part.rows().array() != 0);
      });
    for (const Term& term : e.terms)
      if (const Signal& s = g.signals[at(term.signal)]; is_unknown(s))
        visit(term.signal, [&] { return structure(g, term); });
      else if (s.role == Signal::Role::state && declared[at(s.node)].moved.size() > 0)
        visit_inputs(g, s.node, structure(g, term).rowwise().any(), declared[at(s.node)].moved,
                     visit);
    return;
  }
  const Signal& y = g.signals[at(row.output)];
  const Pattern& D = declared[at(row.node)].direct;
  for (int i = g.nodes[at(row.node)].first_signal; i < end_signal(g, row.node); ++i) {
    const Signal& u = g.signals[at(i)];
    if (u.role != Signal::Role::input || !u.active) continue;
    const auto block = D.block(y.first, u.first, y.size, u.size);
    if (block.any()) visit(i, [&] { return Pattern(block); });
  }
  if (y.active) visit(row.output, [&] { return identity(y.size); });
}

}  // namespace

void Mentioned::add_equation(int equation, std::vector<int>& to) const {
  const Equation& e = g_.equations[at(equation)];
  for (const Term& t : e.terms)
    if (g_.signals[at(t.signal)].active) to.push_back(t.signal);
  if (g_.signals[at(e.target)].active) to.push_back(e.target);
}

void Mentioned::add(const Row& row, std::vector<int>& to) {
  if (row.equation >= 0) return add_equation(row.equation, to);
  const Node& node = g_.nodes[at(row.node)];
  if (node_ != row.node) {
    node_ = row.node;
    fetch_ahead(g_, at(node_));
    direct_ = node.block->feedthrough();
    seen_ = node.block->seen_by();
  }
  const Signal& y = g_.signals[at(row.output)];
  for (int i = node.first_signal; i < end_signal(g_, row.node); ++i) {
    const Signal& s = g_.signals[at(i)];
    if (!s.active) continue;
    if ((s.role == Signal::Role::state && seen_.middleRows(y.first, y.size).any()) ||
        i == row.output ||
        (s.role == Signal::Role::input && direct_.block(y.first, s.first, y.size, s.size).any()))
      to.push_back(i);
  }
}

std::vector<int> mentioned(const Graph& g, const Row& row) {
  std::vector<int> result;
  Mentioned(g).add(row, result);
  return result;
}

Incidence incidence(const Graph& g, bool by_scalar, Sight sight) {
  Incidence inc;
  inc.rows = rows_of(g);
  inc.first_col.assign(g.signals.size(), -1);
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    const Signal& sig = g.signals[at(s)];
    if (!is_unknown(sig)) continue;
    inc.first_col[at(s)] = static_cast<int>(inc.signal_of.size());
    for (int k = 0; k < (by_scalar ? sig.size : 1); ++k) {
      inc.signal_of.push_back(s);
      inc.col_size.push_back(by_scalar ? 1 : sig.size);
    }
  }
  const std::vector<Declared> declared = all_declared(g, sight);
  std::vector<std::vector<int>> lists;  // of the vertices of one row
  for (int r = 0; r < static_cast<int>(inc.rows.size()); ++r) {
    const Row& row = inc.rows[at(r)];
    const int count = by_scalar ? row.size : 1;
    if (lists.size() < at(count)) lists.resize(at(count));
    visit_entries(g, row, declared, [&](int signal, auto pattern) {
      const int col = inc.first_col[at(signal)];
      if (!by_scalar) {
        lists.front().push_back(col);
        return;
      }
      const Pattern p = pattern();
      for (Eigen::Index i = 0; i < p.rows(); ++i)
        for (Eigen::Index j = 0; j < p.cols(); ++j)
          if (p(i, j)) lists[static_cast<std::size_t>(i)].push_back(col + static_cast<int>(j));
    });
    inc.first_row.push_back(inc.row_vertices());
    for (int k = 0; k < count; ++k) {
      auto& list = lists[at(k)];
      detail::keep_each_once(list);
      inc.mentioned.insert(inc.mentioned.end(), list.begin(), list.end());
      inc.begin.push_back(static_cast<int>(inc.mentioned.size()));
      inc.row_of_vertex.push_back(r);
      inc.row_size.push_back(by_scalar ? 1 : row.size);
      list.clear();
    }
  }
  return inc;
}

}  // namespace titop::passes
