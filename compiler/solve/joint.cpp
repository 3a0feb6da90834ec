#include <algorithm>
#include <titop/compiler/passes/incidence.hpp>
#include <titop/compiler/solve/joint.hpp>

namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

using Eigen::MatrixXd;
using passes::is_unknown;

bool carries_value(const Signal& s) {
  return s.role == Signal::Role::external || (s.role == Signal::Role::state && s.active);
}

/// Targets of active equations, and those among them that can be written out.
std::vector<int> written_out_by(const Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<int> times_target(g.signals.size(), 0), by(g.signals.size(), -1);
  for (const Equation& e : g.equations)
    if (e.active) ++times_target[at(e.target)];
  for (int i = 0; i < static_cast<int>(g.equations.size()); ++i) {
    const Equation& e = g.equations[at(i)];
    if (!e.active || !e.part.whole() || !is_unknown(g.signals[at(e.target)])) continue;
    const bool plain = std::all_of(e.terms.begin(), e.terms.end(), [&](const Term& t) {
      return times_target[at(t.signal)] == 0 && g.signals[at(t.signal)].role != Signal::Role::state;
    });
    if (plain) by[at(e.target)] = i;
  }
  return by;
}

const MatrixXd& matrix_of(const Term& t) { return *std::get<Matrix>(t.factors.front()).value; }

void add(std::vector<Piece<double>>& pieces, int signal, MatrixXd c) {
  for (auto& p : pieces)
    if (p.signal == signal) {
      p.c += c;
      return;
    }
  pieces.push_back({signal, std::move(c)});
}

/// Inputs that a block row may depend on, directly (D) or at some s through the states: one plan
/// serves both.
template <class Visit>
void visit_inputs(const Graph& g, const Row& row, Visit visit) {
  const Node& node = g.nodes[at(row.node)];
  for (int i = node.first_signal; i < end_signal(g, row.node); ++i)
    if (g.signals[at(i)].role == Signal::Role::input && g.signals[at(i)].active) visit(i);
}

struct Builder {
  const Stage& stage;
  Joint j;
  std::vector<int> by;

  explicit Builder(const Stage& s) : stage(s), by(written_out_by(s)) {}

  void choose_variables() {
    const Graph& g = stage.graph;
    j.variable_of.assign(g.signals.size(), -1);
    j.meaning.resize(g.signals.size());
    for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
      const Signal& sig = g.signals[at(s)];
      if (!is_unknown(sig) || by[at(s)] >= 0) continue;
      j.variable_of[at(s)] = static_cast<int>(j.variables.size());
      j.variables.push_back(s);
      j.plan.structure.variable_size.push_back(sig.size);
    }
    for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
      const Signal& sig = g.signals[at(s)];
      auto& pieces = j.meaning[at(s)];
      if (j.variable_of[at(s)] >= 0 || carries_value(sig))
        pieces.push_back({s, MatrixXd::Identity(sig.size, sig.size)});
      else if (by[at(s)] >= 0)
        for (const Term& t : g.equations[at(by[at(s)])].terms)
          if (g.signals[at(t.signal)].active ||
              g.signals[at(t.signal)].role == Signal::Role::external)
            add(pieces, t.signal, matrix_of(t));
    }
  }

  /// Variables that a signal stands for; a state stands for the inputs that move it, at some s.
  void mention(std::vector<int>& list, int signal) const {
    const Graph& g = stage.graph;
    if (const Signal& sig = g.signals[at(signal)]; sig.role == Signal::Role::state) {
      for (int i = g.nodes[at(sig.node)].first_signal; sig.active && i < signal; ++i)
        if (g.signals[at(i)].role == Signal::Role::input) mention(list, i);
      return;
    }
    for (const auto& p : j.meaning[at(signal)])
      if (const int v = j.variable_of[at(p.signal)]; v >= 0) list.push_back(v);
  }

  void choose_rows() {
    const Graph& g = stage.graph;
    for (int r = 0; r < static_cast<int>(stage.rows.size()); ++r) {
      const Row& row = stage.rows[at(r)];
      if (!row.active) continue;
      std::vector<int> list;
      if (row.equation >= 0) {
        const Equation& e = g.equations[at(row.equation)];
        if (by[at(e.target)] == row.equation) continue;
        mention(list, e.target);
        for (const Term& t : e.terms) mention(list, t.signal);
      } else {
        mention(list, row.output);
        visit_inputs(g, row, [&](int i) { mention(list, i); });
      }
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      j.rows.push_back(r);
      j.plan.structure.row_size.push_back(row.size);
      j.plan.structure.variables.push_back(std::move(list));
    }
  }
};

/// Collects one row group: coefficient * signal on the left.
template <class T>
struct RowWriter {
  using M = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  const Graph& g;
  const Joint& j;
  const std::vector<int>& variables;
  RowEntries<T>& entries;
  std::vector<Piece<T>>& rhs;
  int size;

  void add(const M& factor, int signal) {
    for (const auto& p : j.meaning[at(signal)]) {
      const bool unit = p.signal == signal;  // a variable stands for itself
      const M c = unit ? factor : M(factor * p.c.template cast<T>());
      const int v = j.variable_of[at(p.signal)];
      if (v < 0) {
        rhs.push_back({p.signal, -c});
        continue;
      }
      const auto k = std::lower_bound(variables.begin(), variables.end(), v) - variables.begin();
      M& entry = entries[static_cast<std::size_t>(k)];
      if (entry.size() == 0)
        entry = c;
      else
        entry += c;
    }
  }
};

template <class T, class FeedThrough, class Output>
Numbers<T> write(const Stage& stage, const Joint& j, FeedThrough feed, Output states) {
  using M = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  const Graph& g = stage.graph;
  Numbers<T> n;
  n.entries.resize(j.rows.size());
  n.rhs.resize(j.rows.size());
  for (std::size_t k = 0; k < j.rows.size(); ++k) {
    const Row& row = stage.rows[at(j.rows[k])];
    const auto& variables = j.plan.structure.variables[k];
    n.entries[k].resize(variables.size());
    RowWriter<T> w{g, j, variables, n.entries[k], n.rhs[k], row.size};
    if (row.equation >= 0) {
      const Equation& e = g.equations[at(row.equation)];
      const int size = g.signals[at(e.target)].size;
      w.add(e.part.whole() ? M(M::Identity(size, size)) : M(e.part.rows.cast<T>()), e.target);
      for (const Term& t : e.terms) w.add(-matrix_of(t).cast<T>(), t.signal);
    } else {
      const Signal& y = g.signals[at(row.output)];
      w.add(M::Identity(y.size, y.size), row.output);
      visit_inputs(g, row, [&](int i) {
        const Signal& u = g.signals[at(i)];
        w.add(-feed(row.node).block(y.first, u.first, y.size, u.size), i);
      });
      states(w, row, y);
    }
    for (std::size_t i = 0; i < variables.size(); ++i)
      if (n.entries[k][i].size() == 0)
        n.entries[k][i] = M::Zero(row.size, j.plan.structure.variable_size[at(variables[i])]);
  }
  return n;
}

}  // namespace

Joint joint(const Stage& stage) {
  Builder b(stage);
  b.choose_variables();
  b.choose_rows();
  b.j.plan = plan(std::move(b.j.plan.structure));
  return std::move(b.j);
}

Numbers<double> numbers(const Stage& stage, const Joint& j,
                        const std::vector<std::shared_ptr<const Dynamics>>& blocks) {
  return write<double>(
      stage, j, [&](int node) -> const MatrixXd& { return blocks[at(node)]->D; },
      [&](RowWriter<double>& w, const Row& row, const Signal& y) {
        const int x = stage.graph.nodes[at(row.node)].state;
        if (x >= 0) w.add(-blocks[at(row.node)]->C.middleRows(y.first, y.size), x);
      });
}

Numbers<std::complex<double>> numbers(const Stage& stage, const Joint& j,
                                      const std::vector<Block::Response>& responses) {
  using T = std::complex<double>;
  Numbers<T> n = write<T>(
      stage, j, [&](int node) -> const Eigen::MatrixXcd& { return responses[at(node)].Y; },
      [](auto&, const Row&, const Signal&) {});
  // States were put on the right-hand side by their coefficient: write them out.
  for (std::size_t k = 0; k < j.rows.size(); ++k) {
    const auto pieces = std::move(n.rhs[k]);
    n.rhs[k].clear();
    RowWriter<T> w{stage.graph,  j,        j.plan.structure.variables[k],
                   n.entries[k], n.rhs[k], stage.rows[at(j.rows[k])].size};
    for (const auto& p : pieces) {
      const Signal& x = stage.graph.signals[at(p.signal)];
      if (x.role != Signal::Role::state) {
        n.rhs[k].push_back(p);
        continue;
      }
      const Node& node = stage.graph.nodes[at(x.node)];
      for (int i = node.first_signal; i < p.signal; ++i) {
        const Signal& u = stage.graph.signals[at(i)];
        if (u.role == Signal::Role::input && u.active)
          w.add(-p.c * responses[at(x.node)].X.middleCols(u.first, u.size), i);
      }
    }
  }
  return n;
}

}  // namespace titop::solve
