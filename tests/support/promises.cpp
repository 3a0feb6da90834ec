#include "support/promises.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <titop/compiler/passes/incidence.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <utility>

namespace titop_test {

using namespace titop;

namespace {

using titop::linalg::at;

void demand(bool holds, const std::string& subject) {
  if (!holds) throw std::logic_error("promise broken: " + subject);
}

}  // namespace

void demand_lowered(const Stage& stage) {
  const Graph& g = stage.graph;
  for (std::size_t i = 1; i < g.nodes.size(); ++i)
    demand(natural_compare(g.nodes[0].name, g.nodes[i].name) < 0, "the first name comes first");
  for (const Node& node : g.nodes)
    demand(node.lowered == node.block->is_algebraic(), node.name + " is an equation");
  const auto lowered = [&](const std::vector<Term>& terms) {
    return std::all_of(terms.begin(), terms.end(), [](const Term& t) {
      return t.of == Term::Of::signal && t.sign == 1 && t.factors.size() == 1 &&
             std::holds_alternative<Matrix>(t.factors.front());
    });
  };
  std::vector<int> driven(g.signals.size(), 0);
  for (const Equation& e : g.equations) {
    demand(!e.accumulate, "no += is left");
    demand(lowered(e.terms), "one coefficient per term in " + print(g, e));
    driven[at(e.target)] +=
        e.part.whole() ? g.signals[at(e.target)].size : static_cast<int>(e.part.rows().rows());
  }
  for (const Output& o : g.outputs)
    demand(lowered(o.terms), "one coefficient per term in " + o.name);
  // The equations of a block that became equations drive the other side of each of its channels.
  for (const Channel& c : g.channels)
    demand(driven[at(c.accel)] + driven[at(c.force)] ==
               (g.nodes[at(c.node)].lowered ? 2 * c.size : c.size),
           "every degree of freedom of a channel is driven once");
}

namespace {

/// Marks all signals that are joined to a marked signal, step by step.
void spread(const Graph& g, std::vector<char>& marked) {
  const auto join = [&](const std::vector<int>& signals) {
    const bool any =
        std::any_of(signals.begin(), signals.end(), [&](int s) { return marked[at(s)] != 0; });
    bool changed = false;
    for (const int s : signals) changed |= any && !std::exchange(marked[at(s)], 1);
    return changed;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
      std::vector<int> own;
      for (int s = g.nodes[at(i)].first_signal; s < end_signal(g, i); ++s) own.push_back(s);
      changed |= join(own);
    }
    for (const Equation& e : g.equations) {
      std::vector<int> mentioned{e.target};
      for (const Term& t : e.terms) mentioned.push_back(t.signal);
      changed |= join(mentioned);
    }
  }
}

}  // namespace

void demand_split(const Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<char> seen(g.signals.size(), g.outputs.empty());
  for (const Output& o : g.outputs)
    for (const Term& t : o.terms) seen[at(t.signal)] = 1;
  spread(g, seen);
  for (std::size_t s = 0; s < g.signals.size(); ++s)
    demand(g.signals[s].role == Signal::Role::external || g.signals[s].active == (seen[s] != 0),
           "a part without output is set aside: " + name_of(g, static_cast<int>(s)));
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// All relations of bodies and equations between positions, as rows over: positions in place of
/// all signals, then all states. States of modes in units of 1/omega.
struct Constraints {
  const Graph& g;
  std::vector<Index> column;  ///< per signal; states too
  std::vector<int> rate_of;   ///< per column of a state: column of its rate, -1
  MatrixXd rows;
  Index columns = 0;

  explicit Constraints(const Stage& stage) : g(stage.graph) {
    for (const Signal& s : g.signals) column.push_back(std::exchange(columns, columns + s.size));
    rate_of.assign(at(static_cast<int>(columns)), -1);
    rows.resize(0, columns);
    for (const Node& node : g.nodes) body(node, stage.values);
    for (const Equation& e : g.equations) {
      const Signal& target = g.signals[at(e.target)];
      const bool motion = target.quantity == Quantity::acceleration && target.channel >= 0;
      if (!motion && (target.channel >= 0 || target.node < 0)) continue;
      if (!motion && !g.nodes[at(target.node)].lowered) continue;
      MatrixXd row = MatrixXd::Zero(e.part.whole() ? target.size : e.part.rows().rows(), columns);
      row.middleCols(column[at(e.target)], target.size) =
          e.part.whole() ? MatrixXd::Identity(target.size, target.size) : e.part.rows();
      for (const Term& t : e.terms)
        row.middleCols(column[at(t.signal)], g.signals[at(t.signal)].size) -=
            coefficient(g, t, stage.values);
      add(row);
    }
  }

  void add(const MatrixXd& more) {
    rows.conservativeResize(rows.rows() + more.rows(), columns);
    rows.bottomRows(more.rows()) = more;
  }

  void body(const Node& node, ParameterValues values) {
    if (node.lowered) return;  // its relations stand among the equations
    const auto k = node.block->kinematics(values);
    if (node.state >= 0) pair_up(node, values);
    for (int i = 0; k && i < static_cast<int>(k->tau.size()); ++i) {
      if (i == k->reference) continue;
      const auto position = [&](int spec) {
        return column[at(g.channels[at(node.first_channel + spec)].accel)];
      };
      MatrixXd row = MatrixXd::Zero(k->tau[at(i)].rows(), columns);
      row.middleCols(position(i), row.rows()).setIdentity();
      row.middleCols(position(k->reference), k->tau[at(i)].cols()) -= k->tau[at(i)];
      if (node.state >= 0)
        row.middleCols(column[at(node.state)], k->Phi[at(i)].cols()) -= k->Phi[at(i)];
      add(row);
    }
  }

  void pair_up(const Node& node, ParameterValues values) {
    const auto d = node.block->dynamics(values);
    for (Index i = 0; i < d->A.rows(); ++i)
      for (Index j = 0; j < d->A.rows(); ++j)
        if (d->A(i, j) == 1 && (d->A.row(i).array() != 0).count() == 1 && i != j)
          rate_of[at(static_cast<int>(column[at(node.state)] + i))] =
              static_cast<int>(column[at(node.state)] + j);
  }

  /// Motions that satisfy all rows, one per column, states at rest left out.
  MatrixXd motions() const {
    MatrixXd all = rows;
    for (const Signal& s : g.signals)
      if (s.role == Signal::Role::state && s.at_rest)
        for (int i = 0; i < s.size; ++i) {
          all.conservativeResize(all.rows() + 1, columns);
          all.bottomRows(1) = Eigen::RowVectorXd::Unit(
              columns, column[at(static_cast<int>(&s - g.signals.data()))] + i);
        }
    return null_space(all);
  }

  static MatrixXd null_space(const MatrixXd& m) {
    if (m.rows() == 0) return MatrixXd::Identity(m.cols(), m.cols());
    const Eigen::JacobiSVD<MatrixXd, Eigen::FullPivHouseholderQRPreconditioner> svd(
        m, Eigen::ComputeFullV);
    Index rank = 0;
    while (rank < svd.singularValues().size() &&
           svd.singularValues()(rank) > 1e-9 * svd.singularValues()(0))
      ++rank;
    return svd.matrixV().rightCols(m.cols() - rank);
  }
};

Index rank_of(const MatrixXd& m) {
  if (m.size() == 0) return 0;
  const Eigen::JacobiSVD<MatrixXd> svd(m);
  return (svd.singularValues().array() > 1e-9).count();
}

}  // namespace

void demand_not_redundant(const Stage& stage) {
  const Constraints c(stage);
  demand(rank_of(c.rows) == c.rows.rows(), "closing equations are independent");
}

void demand_closed(const Stage& stage) {
  const Constraints c(stage);
  const Graph& g = stage.graph;
  const MatrixXd N = c.motions();
  std::set<std::pair<int, int>> gone;
  for (const Dependent& d : stage.dependents) gone.emplace(d.node, d.state);
  std::vector<Index> positions;
  Index kept = 0, kept_rates = 0;
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
    const Node& node = g.nodes[at(i)];
    if (node.state < 0 || !g.signals[at(node.state)].active) continue;
    for (int k = 0; k < g.signals[at(node.state)].size; ++k) {
      const Index column = c.column[at(node.state)] + k;
      const int rate = c.rate_of[at(static_cast<int>(column))];
      if (rate < 0) continue;
      positions.push_back(column);
      kept += !gone.contains({i, k});
      kept_rates += !gone.contains({i, rate - static_cast<int>(c.column[at(node.state)])});
    }
  }
  const Index rank = rank_of(N(positions, Eigen::all));
  demand(kept == rank && kept_rates == rank, "as many states as the motions show");
  for (const Dependent& d : stage.dependents) {
    const auto place = [&](int node, int state) {
      return c.column[at(g.nodes[at(node)].state)] + state;
    };
    if (c.rate_of[at(static_cast<int>(place(d.node, d.state)))] < 0) continue;
    MatrixXd off = N.row(place(d.node, d.state));
    for (const Dependent::Share& s : d.of) off -= s.factor * N.row(place(s.node, s.state));
    demand(off.cwiseAbs().maxCoeff() <= 1e-8, "a dependent state is the sum it is said to be");
  }
}

void demand_matched(const Stage& stage) {
  std::vector<int> of_row(stage.rows.size(), 0), of_signal(stage.graph.signals.size(), 0);
  for (const auto& [row, signal] : stage.matched.rows) ++of_row[at(row)], ++of_signal[at(signal)];
  for (std::size_t r = 0; r < of_row.size(); ++r)
    demand(!stage.rows[r].active || of_row[r] == 1 || of_row[r] == stage.rows[r].size,
           "every row has its unknown");
  for (std::size_t s = 0; s < of_signal.size(); ++s) {
    const Signal& signal = stage.graph.signals[s];
    const bool unknown = passes::is_unknown(signal);
    demand(unknown ? of_signal[s] == 1 || of_signal[s] == signal.size : of_signal[s] == 0,
           "every unknown has its row: " + name_of(stage.graph, static_cast<int>(s)));
  }
}

void demand_ordered(const Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<int> place(g.signals.size(), -1);
  for (std::size_t l = 0; l < stage.loops.size(); ++l)
    for (const int s : stage.loops[l].signals) {
      demand(place[at(s)] < 0, "every unknown is in one loop");
      place[at(s)] = static_cast<int>(l);
    }
  for (std::size_t s = 0; s < g.signals.size(); ++s)
    demand((place[s] >= 0) == passes::is_unknown(g.signals[s]), "every unknown is in a loop");
  for (std::size_t l = 0; l < stage.loops.size(); ++l)
    for (const int row : stage.loops[l].rows)
      for (const int s : passes::mentioned(g, stage.rows[at(row)]))
        demand(!passes::is_unknown(g.signals[at(s)]) || place[at(s)] <= static_cast<int>(l),
               "dependencies first");
}

}  // namespace titop_test
