#include <algorithm>
#include <cmath>
#include <titop/compiler/passes/incidence.hpp>
#include <titop/compiler/solve/joint.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::solve {
namespace {

using linalg::at;

using passes::is_unknown;

bool carries_value(const Signal& s) {
  return s.role == Signal::Role::external || (s.role == Signal::Role::state && s.active);
}

bool counts(const Signal& s) { return s.active || s.role == Signal::Role::external; }

/// Per signal the equation that it can be written out by, -1 for none.
std::vector<int> written_out_by(const Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<int> times_target(g.signals.size(), 0), by(g.signals.size(), -1);
  for (const Equation& e : g.equations)
    if (e.active) ++times_target[at(e.target)];
  for (int i = 0; i < static_cast<int>(g.equations.size()); ++i) {
    const Equation& e = g.equations[at(i)];
    if (!e.active || !e.part.whole() || !is_unknown(g.signals[at(e.target)])) continue;
    // A released equation keeps its row: internal forces are found by its right-hand side.
    if (stage.origins[at(i)].of == Origin::Of::released) continue;
    const bool plain = std::all_of(e.terms.begin(), e.terms.end(), [&](const Term& t) {
      return times_target[at(t.signal)] == 0 && g.signals[at(t.signal)].role != Signal::Role::state;
    });
    if (plain) by[at(e.target)] = i;
  }
  return by;
}

struct JointBuilder {
  const Stage& stage;
  std::vector<Coefficient>& coefficients;
  const Graph& g = stage.graph;
  JointSystem j = {};
  Structure structure = {};
  std::vector<int> by = written_out_by(stage);
  std::vector<int> over = {};  ///< variables of the row being made

  void take_coefficients() {
    const auto take = [&](const std::vector<Term>& terms, std::vector<int>& first) {
      first.push_back(static_cast<int>(coefficients.size()));
      for (const Term& t : terms)
        coefficients.push_back(coefficient_of(*std::get<Matrix>(t.factors.front()).value));
    };
    for (const Equation& e : g.equations) take(e.terms, j.equation_coefficient);
    for (const Output& o : g.outputs) take(o.terms, j.output_coefficient);
  }

  /// signal: -1 for a partial sum; `like`: a signal of its unit.
  void add_variable(int signal, int size, const Signal& like) {
    j.variables.push_back(signal);
    structure.add_variable(size, size == like.size ? entries_per_unit(like) : 1);
  }

  void choose_variables() {
    j.variable_of.assign(g.signals.size(), -1);
    for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
      const Signal& sig = g.signals[at(s)];
      if (!is_unknown(sig) || by[at(s)] >= 0) continue;
      j.variable_of[at(s)] = static_cast<int>(j.variables.size());
      add_variable(s, sig.size, sig);
    }
  }

  void find_meanings() {
    for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
      if (j.variable_of[at(s)] >= 0 || carries_value(g.signals[at(s)])) {
        j.meanings.push_back({s, -1});
      } else if (by[at(s)] >= 0) {
        const auto& terms = g.equations[at(by[at(s)])].terms;
        for (std::size_t k = 0; k < terms.size(); ++k)
          if (counts(g.signals[at(terms[k].signal)]))
            j.meanings.push_back(
                {terms[k].signal, j.equation_coefficient[at(by[at(s)])] + static_cast<int>(k)});
      }
      j.meaning_begin.push_back(static_cast<int>(j.meanings.size()));
    }
  }

  /// Adds piece * signal, with the signal's meaning substituted.
  void add(Piece piece, int signal) {
    for (const SignalTerm& m : j.meaning(signal)) {
      const Signal& signal_of = g.signals[at(m.signal)];
      piece.signal = m.signal;
      piece.size = signal_of.size;
      piece.right = m.coefficient;
      piece.entry = j.variable_of[at(m.signal)];  // the variable, until the row is complete
      if (piece.entry >= 0) over.push_back(piece.entry);
      j.pieces.push_back(piece);
      if (signal_of.role == Signal::Role::state) mention_inputs(m.signal, over);
    }
  }

  /// At some s a state depends on its inputs: one plan serves both.
  void mention_inputs(int state, std::vector<int>& variables) const {
    const int node = g.signals[at(state)].node;
    for (int i = g.nodes[at(node)].first_signal; i < state; ++i)
      if (const Signal& u = g.signals[at(i)]; u.role == Signal::Role::input && u.active)
        for (const SignalTerm& m : j.meaning(i))
          if (const int v = j.variable_of[at(m.signal)]; v >= 0) variables.push_back(v);
  }

  /// The variables on which a piece of the row being made depends.
  std::vector<int> variables_of(const Piece& p) const {
    if (p.entry >= 0) return {p.entry};
    std::vector<int> result;
    if (p.of != Piece::Left::state && g.signals[at(p.signal)].role == Signal::Role::state)
      mention_inputs(p.signal, result);
    return result;
  }

  void add_equation(int index) {
    const Equation& e = g.equations[at(index)];
    Piece target;
    if (!e.part.whole()) {
      target.of = Piece::Left::coefficient;
      target.left = static_cast<int>(coefficients.size());
      coefficients.push_back(std::make_shared<const RowMatrix<double>>(e.part.rows()));
    }
    add(target, e.target);
    for (std::size_t k = 0; k < e.terms.size(); ++k)
      add({.of = Piece::Left::coefficient,
           .sign = -1,
           .left = j.equation_coefficient[at(index)] + static_cast<int>(k)},
          e.terms[k].signal);
  }

  void add_block_row(int node, int output) {
    const Node& n = g.nodes[at(node)];
    const Signal& y = g.signals[at(output)];
    add({}, output);
    for (int i = n.first_signal; i < end_signal(g, node); ++i)
      if (const Signal& u = g.signals[at(i)]; u.role == Signal::Role::input && u.active)
        add({.of = Piece::Left::direct,
             .sign = -1,
             .left = node,
             .row = y.first,
             .rows = y.size,
             .col = u.first,
             .cols = u.size},
            i);
    if (n.state < 0 || !g.signals[at(n.state)].active) return;
    j.pieces.push_back({.of = Piece::Left::state,
                        .sign = -1,
                        .left = node,
                        .row = y.first,
                        .rows = y.size,
                        .signal = n.state,
                        .size = g.signals[at(n.state)].size});
  }

  void add_rows() {
    constexpr std::size_t kPerRow = 4;  // of a two-port block: about as many as there will be
    j.pieces.reserve(kPerRow * stage.rows.size());
    for (int r = 0; r < static_cast<int>(stage.rows.size()); ++r) {
      const Row& row = stage.rows[at(r)];
      if (!row.active) continue;
      if (row.equation >= 0 && by[at(g.equations[at(row.equation)].target)] == row.equation)
        continue;
      over.clear();
      if (row.equation >= 0)
        add_equation(row.equation);
      else
        add_block_row(row.node, row.output);
      close_row(r, row.size);
    }
  }

  /// The row is complete. A row over many variables (a hub's force, a sum of a thousand sensors,
  /// the position of the tip of a long chain) would be carried through the fronts of all of them:
  /// it is split into partial sums, which are unknowns.
  void close_row(int stage_row, int size) {
    detail::keep_each_once(over);
    const Row& row = stage.rows[at(stage_row)];
    const int target = row.equation >= 0 ? g.equations[at(row.equation)].target : row.output;
    while (over.size() > kMost) sum_up(stage_row, size, g.signals[at(target)]);
    finish_row(stage_row, size, over);
  }

  static constexpr std::size_t kMost = 12, kTogether = 4;

  /// Replaces each four neighbouring variables of the row by their partial sum; a state goes with
  /// the first of its inputs; its row also contains the other inputs.
  void sum_up(int stage_row, int size, const Signal& like) {
    const auto begin = j.pieces.begin() + j.piece_begin.back();
    const std::vector<Piece> all(begin, j.pieces.end());
    std::vector<Piece> top;
    j.pieces.erase(begin, j.pieces.end());
    struct Group {
      std::vector<Piece> pieces;
      std::vector<int> members;
    };
    std::vector<Group> groups((over.size() + kTogether - 1) / kTogether);
    for (const Piece& p : all) {
      const std::vector<int> of = variables_of(p);
      const auto first = std::lower_bound(
          over.begin(), over.end(), of.empty() ? -1 : *std::min_element(of.begin(), of.end()));
      Group& group = groups[static_cast<std::size_t>(first - over.begin()) / kTogether];
      (of.empty() ? top : group.pieces).push_back(p);
      if (!of.empty()) group.members.insert(group.members.end(), of.begin(), of.end());
    }
    std::vector<int> sums;
    for (Group& group : groups) {
      if (group.pieces.empty()) continue;
      const int sum = static_cast<int>(j.variables.size());
      add_variable(-1, size, like);
      sums.push_back(sum);
      top.push_back({.of = Piece::Left::one, .entry = sum, .size = size});
      group.pieces.push_back({.of = Piece::Left::one, .sign = -1, .entry = sum, .size = size});
      group.members.push_back(sum);
      j.pieces.insert(j.pieces.end(), group.pieces.begin(), group.pieces.end());
      finish_row(stage_row, size, group.members);
    }
    j.pieces.insert(j.pieces.end(), top.begin(), top.end());
    over = std::move(sums);
  }

  void finish_row(int stage_row, int size, const std::vector<int>& variables_of_row) {
    structure.add_row(size, variables_of_row);
    const auto variables = structure.row(static_cast<int>(j.rows.size()));
    for (std::size_t p = at(j.piece_begin.back()); p < j.pieces.size(); ++p)
      if (int& entry = j.pieces[p].entry; entry >= 0)
        entry = static_cast<int>(std::lower_bound(variables.begin(), variables.end(), entry) -
                                 variables.begin());
    j.rows.push_back(stage_row);
    j.piece_begin.push_back(static_cast<int>(j.pieces.size()));
  }
};

}  // namespace

Coefficient coefficient_of(const Eigen::MatrixXd& c) {
  static const auto plus = std::make_shared<const RowMatrix<double>>(RowMatrix<double>::Ones(1, 1)),
                    minus = std::make_shared<const RowMatrix<double>>(-*plus);
  if (c.size() == 1 && std::abs(c(0, 0)) == 1) return c(0, 0) > 0 ? plus : minus;  // most scalars
  return std::make_shared<const RowMatrix<double>>(c);
}

JointSystem joint(const Stage& stage, std::vector<Coefficient>& coefficients) {
  JointBuilder b{stage, coefficients};
  b.take_coefficients();
  b.choose_variables();
  b.find_meanings();
  b.add_rows();
  b.j.plan = std::make_shared<const Plan>(plan(std::move(b.structure)));
  return std::move(b.j);
}

}  // namespace titop::solve
