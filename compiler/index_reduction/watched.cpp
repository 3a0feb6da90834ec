#include <titop/compiler/index_reduction/watched.hpp>
#include <titop/compiler/solve/piece_matrix.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

/// Readers of each state.
struct Readers {
  const Skeleton& k;
  const Factored& d;
  const Graph& g = k.stage.graph;

  bool is_state(int signal) const {
    return signal >= 0 && g.signals[at(signal)].role == Signal::Role::state &&
           g.signals[at(signal)].active;
  }

  /// Calls visit(row, state) for the entries of c, over a state signal, that are not 0.
  template <class Visit>
  void entries(const MatrixXd& c, int signal, Visit visit) const {
    for (Index j = 0; j < c.cols(); ++j)
      for (Index i = 0; i < c.rows(); ++i)
        if (c(i, j) != 0) visit(i, d.layout().known_first[at(signal)] + j);
  }

  /// The same for c times the meaning of a signal.
  template <class Visit>
  void of_signal(const MatrixXd& c, int signal, Visit visit) const {
    for (const solve::SignalTerm& m : k.joint.meaning(signal))
      if (is_state(m.signal))
        entries(
            m.coefficient < 0 ? c : solve::product(c, *d.numbers.coefficients[at(m.coefficient)]),
            m.signal, visit);
  }

  /// Calls visit(state) for the states that rows and outputs read.
  template <class Visit>
  void from_outside(Visit visit) const {
    const auto state = [&](Index, Index j) { visit(j); };
    for (const solve::Piece& p : k.joint.pieces)
      if (p.entry < 0 && is_state(p.signal))
        entries(solve::matrix_of(p, d.numbers), p.signal, state);
    for (std::size_t o = 0; o < g.outputs.size(); ++o)
      for (std::size_t t = 0; t < g.outputs[o].terms.size(); ++t)
        of_signal(*d.numbers.coefficients[at(k.joint.output_coefficient[o]) + t],
                  g.outputs[o].terms[t].signal, state);
  }

  /// Calls visit(state, read) for the states that rates read at once.
  template <class Visit>
  void by_rates(Visit visit) const {
    for (const int i : d.layout().state_nodes) {
      const Node& node = g.nodes[at(i)];
      const Dynamics& m = *d.numbers.blocks[at(i)];
      const auto entry = [&](Index row, Index read) {
        visit(d.layout().state_first[at(i)] + row, read);
      };
      entries(m.A, node.state, entry);
      for (int s = node.first_signal; s < node.state; ++s)
        if (const Signal& u = g.signals[at(s)]; u.role == Signal::Role::input && u.active)
          of_signal(m.B.middleCols(u.first, u.size), s, entry);
    }
  }

  /// Marks to(state, read) if from(state, read) is marked, until no mark is added.
  template <class From, class To>
  void spread(StateMarks& marks, From from, To to) const {
    for (bool changed = true; changed;) {
      changed = false;
      by_rates([&](Index state, Index read) {
        char& mark = marks[at(to(state, read))];
        if (!mark && marks[at(from(state, read))]) mark = 1, changed = true;
      });
    }
  }
};

Index reader(Index state, Index) { return state; }
Index what_is_read(Index, Index read) { return read; }

}  // namespace

StateMarks watched_states(const Skeleton& k, const Factored& d) {
  const Readers readers{k, d};
  StateMarks marks(at(d.layout().order()), 0);
  readers.from_outside([&](Index state) { marks[at(state)] = 1; });
  readers.spread(marks, reader, what_is_read);
  return marks;
}

StateMarks moved_with(const Skeleton& k, const Factored& d, StateMarks states) {
  Readers{k, d}.spread(states, what_is_read, reader);
  return states;
}

}  // namespace titop::detail
