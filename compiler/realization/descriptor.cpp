#include <titop/compiler/realization/descriptor.hpp>
#include <titop/compiler/realization/write_model.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/piece_matrix.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop {
namespace {

using detail::Factored;
using detail::StateMap;
using solve::Piece;
using solve::RowMatrix;
using Triplets = std::vector<Eigen::Triplet<double>>;
using linalg::at;

struct DescriptorBuilder {
  const Factored& d;
  const detail::Skeleton& k = *d.skeleton;
  const Graph& g = d.graph();
  int states = static_cast<int>(d.layout().order());
  Triplets A = {}, B = {}, C = {}, D = {};

  /// Column of a variable or state in v, or of an input in u (`input`).
  struct ColumnPlace {
    int first;
    bool input;
  };
  ColumnPlace place(int signal) const {
    if (const int v = k.joint.variable_of[at(signal)]; v >= 0)
      return {states + k.joint.plan->first[at(v)], false};
    const int first = d.layout().known_first[at(signal)];
    return first < states ? ColumnPlace{first, false} : ColumnPlace{first - states, true};
  }

  const RowMatrix<double>& coefficient(int i) const { return *d.numbers.coefficients[at(i)]; }

  template <class Matrix>
  static void put(Triplets& to, int row, int column, const Matrix& m, double sign = 1) {
    for (int j = 0; j < m.cols(); ++j)
      for (int i = 0; i < m.rows(); ++i)
        if (const double x = m(i, j); x != 0) to.emplace_back(row + i, column + j, sign * x);
  }

  /// factor * signal, in rows of (by_v, by_u).
  template <class Matrix>
  void add(Triplets& by_v, Triplets& by_u, int row, const Matrix& factor, int signal) {
    for (const solve::SignalTerm& m : k.joint.meaning(signal)) {
      const ColumnPlace p = place(m.signal);
      Triplets& to = p.input ? by_u : by_v;
      if (m.coefficient < 0)
        put(to, row, p.first, factor);
      else
        put(to, row, p.first, Eigen::MatrixXd(factor * coefficient(m.coefficient)));
    }
  }

  void add_states() {
    for (const int i : d.layout().state_nodes) {
      const Node& node = g.nodes[at(i)];
      const Dynamics& m = *d.numbers.blocks[at(i)];
      const int first = d.layout().state_first[at(i)];
      put(A, first, first, m.A);
      for (int s = node.first_signal; s < node.state; ++s)
        if (const Signal& u = g.signals[at(s)]; u.role == Signal::Role::input && u.active)
          add(A, B, first, m.B.middleCols(u.first, u.size), s);
    }
  }

  void add_rows() {
    const solve::Plan& plan = *k.joint.plan;
    for (int r = 0; r < static_cast<int>(k.joint.rows.size()); ++r)
      for (const Piece& p : k.joint.row(r)) {
        const ColumnPlace to =
            p.entry < 0
                ? place(p.signal)
                : ColumnPlace{states + plan.first[at(plan.structure.row(r)[at(p.entry)])], false};
        put(to.input ? B : A, states + plan.row_first[at(r)], to.first,
            solve::matrix_of(p, d.numbers));
      }
  }

  void add_outputs() {
    for (std::size_t o = 0; o < g.outputs.size(); ++o)
      for (std::size_t t = 0; t < g.outputs[o].terms.size(); ++t)
        add(C, D, d.layout().output_first[o],
            coefficient(k.joint.output_coefficient[o] + static_cast<int>(t)),
            g.outputs[o].terms[t].signal);
  }

  /// The model's states first, then the dependent ones, which have 0 = T x - x in place of their
  /// derivatives.
  void set_dependents_apart() {
    if (d.states.trivial()) return;
    shift_by_inputs();
    std::vector<int> place(at(states), -1);
    int next = 0;
    for (const int i : d.states.kept()) place[at(i)] = next++;
    for (const StateMap::DependentRow& row : d.states.dependent()) place[at(row.state)] = next++;
    const auto moved = [&](const Triplets& list, bool rows, bool columns) {
      Triplets result;
      for (const auto& t : list) {
        const int i = rows && t.row() < states ? place[at(t.row())] : t.row();
        const int j = columns && t.col() < states ? place[at(t.col())] : t.col();
        if (!rows || i < d.states.order() || i >= states) result.emplace_back(i, j, t.value());
      }
      return result;
    };
    A = moved(A, true, true), B = moved(B, true, false), C = moved(C, false, true);
    for (const StateMap::DependentRow& row : d.states.dependent()) {
      A.emplace_back(place[at(row.state)], place[at(row.state)], -1.0);
      for (const auto& [of, factor] : row.of)
        A.emplace_back(place[at(row.state)], place[at(of)], factor);
      for (int j = 0; j < d.states.by_input().cols(); ++j)
        if (const double r = d.states.by_input()(row.state, j); r != 0)
          B.emplace_back(place[at(row.state)], j, r);
    }
  }

  /// Kept states of the blocks are those of the model + R u.
  void shift_by_inputs() {
    const Eigen::MatrixXd& R = d.states.by_input();
    if (R.size() == 0) return;
    std::vector<char> kept(at(states), 0);
    for (const int i : d.states.kept()) kept[at(i)] = 1;
    const auto shift = [&](const Triplets& by_v, Triplets& by_u) {
      for (const auto& t : by_v)
        for (int j = 0; t.col() < states && kept[at(t.col())] && j < R.cols(); ++j)
          if (R(t.col(), j) != 0) by_u.emplace_back(t.row(), j, t.value() * R(t.col(), j));
    };
    shift(A, B), shift(C, D);
  }

  std::vector<std::string> names() const {
    std::vector<std::string> result = d.state_names();
    for (const StateMap::DependentRow& row : d.states.dependent())
      result.push_back(d.layout().states[at(row.state)]);
    result.resize(at(states + k.joint.plan->unknowns));
    for (std::size_t v = 0; v < k.joint.variables.size(); ++v) {
      const int size = k.joint.plan->structure.variable_size[v];
      const int signal = k.joint.variables[v];
      const std::string name = signal < 0 ? "partial sum " + std::to_string(v) : name_of(g, signal);
      for (int i = 0; i < size; ++i)
        result[at(states + k.joint.plan->first[v] + i)] =
            size == 1 ? name : name + "(" + std::to_string(i + 1) + ")";
    }
    return result;
  }
};

/// The matrix of these entries, duplicates summed; keeps the matrix's pattern if it contains them
/// all.
void fill(Eigen::SparseMatrix<double>& m, Eigen::Index rows, Eigen::Index cols,
          const Triplets& list) {
  if (m.rows() == rows && m.cols() == cols && m.isCompressed()) {
    m.coeffs().setZero();
    for (auto t = list.begin(); t != list.end() && m.isCompressed(); ++t)
      m.coeffRef(t->row(), t->col()) += t->value();
    if (m.isCompressed()) return;  // no entry was new
  }
  m.resize(rows, cols);
  m.setFromTriplets(list.begin(), list.end());
}

}  // namespace

void detail::write_descriptor(const Factored& d, Descriptor& form) {
  DescriptorBuilder b{d};
  b.add_states();
  b.add_rows();
  b.add_outputs();
  b.set_dependents_apart();
  const Eigen::Index n = b.states + b.k.joint.plan->unknowns;
  const auto nu = static_cast<Eigen::Index>(d.layout().inputs.size());
  const auto ny = static_cast<Eigen::Index>(d.layout().outputs.size());
  Triplets e;
  for (int i = 0; i < d.states.order(); ++i) e.emplace_back(i, i, 1.0);
  fill(form.E, n, n, e);
  fill(form.A, n, n, b.A);
  fill(form.B, n, nu, b.B);
  fill(form.C, ny, n, b.C);
  fill(form.D, ny, nu, b.D);
  form.states = d.states.order();
  form.names = b.names();
  form.inputs = d.layout().inputs;
  form.outputs = d.layout().outputs;
}

}  // namespace titop
