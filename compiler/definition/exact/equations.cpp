#include <fmt/format.h>

#include <titop/compiler/definition/exact/coefficients.hpp>
#include <titop/compiler/definition/exact/equations.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::exact {
namespace {

using Eigen::Index;
using linalg::at;

/// All equations as rows over these columns, in this order: port signals; rates of all states and
/// outputs, which are wanted; states and inputs, which are known.
struct EquationColumns {
  std::vector<int> of_signal;  ///< port signal: itself; state: its value; external: the input
  std::vector<int> rate;       ///< of a signal that is a state
  /// For a signal whose integral is read: first of its rate's states; its position's follow.
  std::vector<int> integral;
  int ports = 0, outputs = 0, states = 0, inputs = 0;

  int first_rate() const { return ports; }
  int first_output() const { return ports + states; }
  int first_state() const { return ports + states + outputs; }
  int first_input() const { return ports + 2 * states + outputs; }

  explicit EquationColumns(const Graph& g)
      : of_signal(g.signals.size(), -1),
        rate(g.signals.size(), -1),
        integral(g.signals.size(), -1) {
    for (const Equation& e : g.equations) count_integrals(g, e.terms);
    for (const Output& o : g.outputs) count_integrals(g, o.terms), outputs += o.size;
    for (std::size_t s = 0; s < g.signals.size(); ++s)
      if (g.signals[s].role == Signal::Role::state) rate[s] = states, states += g.signals[s].size;
    for (std::size_t s = 0; s < g.signals.size(); ++s)
      if (const auto role = g.signals[s].role;
          role == Signal::Role::input || role == Signal::Role::output)
        of_signal[s] = ports, ports += g.signals[s].size;
    for (std::size_t s = 0; s < g.signals.size(); ++s) {
      if (rate[s] >= 0) of_signal[s] = first_state() + rate[s], rate[s] += first_rate();
      if (g.signals[s].role == Signal::Role::external)
        of_signal[s] = first_input() + inputs, inputs += g.signals[s].size;
    }
  }

 private:
  void count_integrals(const Graph& g, const std::vector<Term>& terms) {
    for (const Term& t : terms)
      if ((t.of == Term::Of::position || t.of == Term::Of::rate) && integral[at(t.signal)] < 0)
        integral[at(t.signal)] = states, states += 2 * g.signals[at(t.signal)].size;
  }
};

/// C and D of a block: of its modal form if it has one, since rounded products of its modes would
/// satisfy no closure.
class ExactBlock {
 public:
  explicit ExactBlock(const Dynamics& d) : d_(d) {}

  /// Some rows of C.
  ExactMatrix states(Index row, Index rows) const {
    if (!d_.modal) return exact_matrix(d_.C.middleRows(row, rows));
    const Index n = d_.modal->W.rows();
    const ExactMatrix W = exact_matrix(d_.modal->W.middleCols(row, rows)),
                      stiffness = exact_matrix(d_.modal->stiffness),
                      damping = exact_matrix(d_.modal->damping);
    ExactMatrix C(rows, 2 * n);
    for (Index i = 0; i < rows; ++i)
      for (Index k = 0; k < n; ++k) {
        C(i, k) = -W(k, i) * stiffness(k, 0);
        C(i, n + k) = -W(k, i) * damping(k, 0);
      }
    return C;
  }
  /// A part of D.
  ExactMatrix direct(Index row, Index col, Index rows, Index cols) const {
    if (!d_.modal)
      return exact_matrix(d_.direct(static_cast<int>(row), static_cast<int>(col),
                                    static_cast<int>(rows), static_cast<int>(cols)));
    ExactMatrix D = exact_matrix(d_.modal->W.middleCols(row, rows)).transposed() *
                    exact_matrix(d_.modal->W.middleCols(col, cols));
    const ExactMatrix rigid = exact_matrix(d_.modal->rigid.block(row, col, rows, cols));
    for (std::size_t i = 0; i < D.entries.size(); ++i) D.entries[i] += rigid.entries[i];
    return D;
  }

 private:
  const Dynamics& d_;
};

class ExactAssembly {
 public:
  ExactAssembly(const Graph& g, const ExactOptions& options, ParameterValues values)
      : g_(g), values_(values), rotations_(options.rotations), columns_(g), drive_(g) {
    if (columns_.states > options.states)
      throw Undecided{fmt::format("{} states are more than {} (ExactOptions::states)",
                                  columns_.states, options.states)};
    if (columns_.ports + columns_.states > options.unknowns)
      throw Undecided{fmt::format("{} unknowns are more than {} (ExactOptions::unknowns)",
                                  columns_.ports + columns_.states, options.unknowns)};
    for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) add_block(i);
    for (std::size_t c = 0; c < drive_.size(); ++c) add_channel(g.channels[c], drive_[c]);
    for (const Equation& e : g.equations)
      if (const Signal& target = g.signals[at(e.target)]; target.channel < 0)
        define(columns_.of_signal[at(e.target)], target.size, e.terms);
    int column = columns_.first_output();
    for (const Output& o : g.outputs) define(column, o.size, o.terms), column += o.size;
    add_integrators();
  }

  const EquationColumns& columns() const { return columns_; }
  const Echelon& rows() const { return rows_; }

 private:
  using ExactRows = std::vector<Entries>;  ///< some rows at once

  /// rows += m * (columns from `first` on)
  static void add(ExactRows& rows, const ExactMatrix& m, int first, int sign = 1) {
    for (Index i = 0; i < m.rows; ++i)
      for (Index j = 0; j < m.cols; ++j)
        if (m(i, j) != 0)
          rows[static_cast<std::size_t>(i)][first + static_cast<int>(j)] +=
              sign > 0 ? m(i, j) : -m(i, j);
  }
  void take(const ExactRows& rows) {
    for (const Entries& row : rows) rows_.add(to_row(row));
  }

  /// rows -= factor * terms
  void subtract(ExactRows& rows, const ExactMatrix& factor, const std::vector<Term>& terms) {
    for (const Term& t : terms) {
      const ExactMatrix c = factor * exact_coefficient(g_, t, values_, rotations_);
      const int integral = columns_.first_state() + columns_.integral[at(t.signal)];
      add(rows, c,
          t.of == Term::Of::rate       ? integral
          : t.of == Term::Of::position ? integral + g_.signals[at(t.signal)].size
                                       : columns_.of_signal[at(t.signal)],
          -1);
      if (t.of == Term::Of::reaction)
        subtract_forces(rows, Residue(-1) * c, drive_[at(g_.signals[at(t.signal)].channel)].added);
    }
  }
  void subtract_forces(ExactRows& rows, const ExactMatrix& factor, std::span<const int> equations) {
    for (const int e : equations) {
      const Part& part = g_.equations[at(e)].part;
      subtract(rows,
               part.whole() ? factor
                            : factor * orthonormal_fractions(part.rows(), part.name()).transposed(),
               g_.equations[at(e)].terms);
    }
  }

  void define(int column, int size, const std::vector<Term>& terms) {
    ExactRows rows(at(size));
    add(rows, ExactMatrix::identity(size), column);
    subtract(rows, ExactMatrix::identity(size), terms);
    take(rows);
  }

  void add_channel(const Channel& channel, const Drive& drive) {
    // If no acceleration is driven: all of the space, less the driven directions.
    ExactMatrix rest = ExactMatrix::identity(channel.size);
    for (const int e : drive.accel) {
      const Part& part = g_.equations[at(e)].part;
      const ExactMatrix S = part.whole() ? ExactMatrix::identity(channel.size)
                                         : orthonormal_fractions(part.rows(), part.name());
      ExactRows rows(static_cast<std::size_t>(S.rows));
      add(rows, S, columns_.of_signal[at(channel.accel)]);
      subtract(rows, ExactMatrix::identity(S.rows), g_.equations[at(e)].terms);
      take(rows);
      const ExactMatrix projector = S.transposed() * S;
      for (std::size_t i = 0; i < rest.entries.size(); ++i) rest.entries[i] -= projector.entries[i];
    }
    if (drive.free == 0) return;
    ExactRows rows(at(channel.size));
    add(rows, rest, columns_.of_signal[at(channel.force)]);
    subtract_forces(rows, rest, drive.force);
    subtract_forces(rows, rest, drive.added);
    take(rows);
  }

  void add_block(int index) {
    const Node& node = g_.nodes[at(index)];
    const auto d = node.block->dynamics(values_);
    const ExactBlock exact(*d);
    const int end = end_signal(g_, index);
    const auto equation = [&](int column, const Signal* y) {
      const Index row = y ? y->first : 0, size = y ? y->size : d->A.rows();
      ExactRows rows(static_cast<std::size_t>(size));
      add(rows, ExactMatrix::identity(size), column);
      if (node.state >= 0)
        add(rows, y ? exact.states(row, size) : exact_matrix(d->A),
            columns_.of_signal[at(node.state)], -1);
      for (int i = node.first_signal; i < end; ++i)
        if (const Signal& u = g_.signals[at(i)]; u.role == Signal::Role::input)
          add(rows,
              y ? exact.direct(y->first, u.first, y->size, u.size)
                : exact_matrix(d->B.middleCols(u.first, u.size)),
              columns_.of_signal[at(i)], -1);
      take(rows);
    };
    if (node.state >= 0) equation(columns_.rate[at(node.state)], nullptr);
    for (int o = node.first_signal; o < end; ++o)
      if (const Signal& y = g_.signals[at(o)]; y.role == Signal::Role::output)
        equation(columns_.of_signal[at(o)], &y);
  }

  void add_integrators() {
    for (std::size_t s = 0; s < columns_.integral.size(); ++s) {
      const int first = columns_.integral[s], size = g_.signals[s].size;
      if (first < 0) continue;
      ExactRows rows(at(2 * size));
      for (int i = 0; i < size; ++i) {
        rows[at(i)] = {{columns_.first_rate() + first + i, 1}, {columns_.of_signal[s] + i, -1}};
        rows[at(size + i)] = {{columns_.first_rate() + first + size + i, 1},
                              {columns_.first_state() + first + i, -1}};
      }
      take(rows);
    }
  }

  const Graph& g_;
  ParameterValues values_;
  ExactRotations rotations_;
  EquationColumns columns_;
  Drives drive_;
  Echelon rows_;
};

/// Every wanted column as a combination of the known ones, which count from 0.
std::vector<Entries> solve(const EquationColumns& c, const Echelon& all) {
  const int first = c.first_rate(), known = c.first_state();
  if (all.rows().lower_bound(known) != all.rows().end())
    throw Undecided{"the equations constrain states or inputs, as those of an improper transfer"};
  std::vector<Entries> result(at(known - first));
  for (int w = known - 1; w >= first; --w) {
    const auto found = all.rows().find(w);
    if (found == all.rows().end())
      throw Undecided{"the equations do not determine all states and outputs"};
    const SparseRow& row = found->second;
    for (auto entry = row.begin() + 1; entry != row.end(); ++entry) {
      const Residue factor = -entry->second;  // of a row whose leading entry is 1
      if (entry->first >= known) {
        result[at(w - first)][entry->first - known] += factor;
        continue;
      }
      for (const auto& [k, value] : result[at(entry->first - first)])
        result[at(w - first)][k] += factor * value;
    }
  }
  return result;
}

/// From the rows of [A, B] and of C.
Model model_from(int states, int inputs, const std::vector<Entries>& rates,
                 const std::vector<Entries>& outputs) {
  Model m;
  m.states = states;
  m.A.columns.resize(at(states));
  m.A_transposed.columns.resize(at(states));
  std::vector<Entries> B(at(inputs));
  for (int i = 0; i < states; ++i)
    for (const auto& [k, value] : rates[at(i)]) {
      if (k >= states) {
        B[at(k - states)][i] = value;
        continue;
      }
      m.A.columns[at(k)].emplace_back(i, value);
      m.A_transposed.columns[at(i)].emplace_back(k, value);
    }
  for (const Entries& column : B) m.B.push_back(to_row(column));
  for (Entries row : outputs) {
    Entries direct;
    for (auto entry = row.lower_bound(states); entry != row.end(); ++entry)
      direct[entry->first - states] = entry->second;
    m.D.push_back(to_row(direct));
    row.erase(row.lower_bound(states), row.end());
    m.C.push_back(to_row(row));
  }
  return m;
}

}  // namespace

Model model_of(const Graph& graph, const ExactOptions& options, ParameterValues values) {
  const ExactAssembly a(graph, options, values);
  const EquationColumns& c = a.columns();
  const std::vector<Entries> wanted = solve(c, a.rows());
  return model_from(c.states, c.inputs, {wanted.begin(), wanted.begin() + c.states},
                    {wanted.begin() + c.states, wanted.end()});
}

Model model_of(const StateSpace& model) {
  const auto n = model.A.rows();
  const ExactMatrix A = exact_matrix(model.A), B = exact_matrix(model.B), C = exact_matrix(model.C);
  std::vector<Entries> rates(static_cast<std::size_t>(n)), outputs;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j)
      if (A(i, j) != 0) rates[static_cast<std::size_t>(i)][static_cast<int>(j)] = A(i, j);
    for (Index j = 0; j < B.cols; ++j)
      if (B(i, j) != 0) rates[static_cast<std::size_t>(i)][static_cast<int>(n + j)] = B(i, j);
  }
  outputs.resize(static_cast<std::size_t>(C.rows));
  for (Index i = 0; i < C.rows; ++i)
    for (Index j = 0; j < n; ++j)
      if (C(i, j) != 0) outputs[static_cast<std::size_t>(i)][static_cast<int>(j)] = C(i, j);
  return model_from(model.order(), static_cast<int>(B.cols), rates, outputs);
}

}  // namespace titop::exact
