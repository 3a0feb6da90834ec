#include <algorithm>
#include <atomic>
#include <cmath>
#include <latch>
#include <titop/compiler/realization/kept.hpp>
#include <titop/compiler/realization/terms.hpp>
#include <titop/compiler/realization/write_model.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/piece_matrix.hpp>
#include <titop/compiler/solve/products.hpp>
#include <titop/compiler/solve/propagation.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/parallel.hpp>

/// The dense model from the factors: evaluates the plan `Writing`.
namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;
using solve::RowMatrix;

/// Releases waiting tasks, even if this task has thrown: its numbers are not used then.
struct CountDown {
  std::latch& latch;
  ~CountDown() { latch.count_down(); }
};

class DenseWriter {
 public:
  DenseWriter(const Factored& d, StateSpace& m, int threads)
      : d_(d),
        k_(*d.skeleton),
        m_(m),
        w_(writing_of(d)),
        states_(d.layout().order()),
        rows_(states_ + static_cast<Index>(d.layout().outputs.size())),
        threads_(threads) {}

  void write() {
    resize();
    Kept& kept = kept_by_thread();
    solve::Propagation propagation(*d_.factors, kept.products);
    const std::size_t batches = w_->batches.size() - 1;
    for (std::size_t i = 0; i < batches; ++i) width_ = std::max(width_, w_->width(i));
    kept.coefficients.assign(at(w_->coefficients), 0);
    // The data that batches read are computed by tasks, too: these come first, and all others wait
    // for them. Only the last of them may throw: tasks behind one that throws are not begun, and
    // the others would wait for ever.
    constexpr std::size_t kFirst = 4;
    std::latch first(kFirst);
    const auto prepare = [&](std::size_t i) {
      const CountDown done{first};
      switch (i) {
        case 0: return propagation.form(0, 2);
        case 1: return propagation.form(1, 2);
        case 2: return find_coefficients(d_, *w_, kept.coefficients.data());
        default: return name();
      }
    };
    const std::size_t tasks = kFirst + batches;
    const int count = thread_count(threads(batches), tasks);
    kept.rooms.resize(std::max(kept.rooms.size(), at(count)));
    const auto write = [&](std::size_t batch, Room& room) {
      room.clear_for(w_, at(rows_ * width_));
      first.wait();
      columns(propagation, kept.coefficients.data(), batch, room);
    };
    std::atomic<std::size_t> next{0};
    parallel(tasks, count, [&] {
      return [&prepare, &write, &room = kept.rooms[next++]](std::size_t i) {
        i < kFirst ? prepare(i) : write(i - kFirst, room);
      };
    });
    if (kept.is_large()) kept = {};
    add_direct_terms(d_, *w_, m_);
  }

 private:
  /// To wake a thread and wait for it takes longer than to write a small model.
  int threads(std::size_t batches) const {
    constexpr std::size_t kWorthIt = 50'000;  // entries of the solutions, about 2 ns each
    const std::size_t entries = batches * Writing::kBatch * at(k_.joint.plan->unknowns);
    return entries < kWorthIt ? 1 : threads_;
  }

  void resize() {
    const auto inputs = static_cast<Index>(d_.layout().inputs.size());
    const auto outputs = static_cast<Index>(d_.layout().outputs.size());
    m_.A.resize(states_, states_);
    m_.B.resize(states_, inputs);
    m_.C.resize(outputs, states_);
    m_.D.resize(outputs, inputs);
  }
  void name() {
    m_.states = d_.layout().states;
    m_.inputs = d_.layout().inputs;
    m_.outputs = d_.layout().outputs;
  }

  const Dynamics& block(int node) const { return *d_.numbers.blocks[at(node)]; }

  // --- columns ---------------------------------------------------------------------------------

  /// Solves for the sources of a batch and writes their columns. The values of [xdot; y] are stored
  /// row by row.
  void columns(const solve::Propagation& propagation, const double* coefficients, std::size_t batch,
               Room& room) {
    const Index m = w_->width(batch);
    propagation.begin(m, room.space);
    Index first = 0;
    for (std::size_t i = w_->batches[batch]; i < w_->batches[batch + 1]; ++i) {
      act(w_->sources[i], first, propagation, room.space);
      first += w_->sources[i].columns;
    }
    propagation.solve(room.space);
    for (const Writing::Target& t : w_->targets) read(t, coefficients, m, room);
    write_columns(batch, room);
  }

  /// The target's rows of all m columns.
  void read(const Writing::Target& t, const double* coefficients, Index m, Room& room) const {
    if (t.unknowns.empty()) return;
    room.reads.clear();
    for (const Writing::IndexRange& r : t.unknowns)
      for (Index i = r.first; i < r.first + r.size; ++i)
        room.reads.push_back(room.space.z.data() + i * m);
    solve::multiply(t.rows, t.inner, m, coefficients + t.coefficients, t.inner, room.reads.data(),
                    nullptr, room.values.data() + t.row * width_, width_);
  }

  /// The source's right-hand sides, from column `first` on.
  void act(const Writing::Source& s, Index first, const solve::Propagation& propagation,
           solve::Propagation::Space& space) const {
    const Index m = space.m;
    for (const auto& [group, piece] : s.acts) {
      const solve::Piece& p = k_.joint.pieces[at(piece)];
      double* const to = propagation.rhs(group, space) + first;
      if (!s.modal) {
        Eigen::Map<RowMatrix<double>, 0, Eigen::OuterStride<>>(
            to, k_.joint.plan->structure.row_size[at(group)], s.columns, Eigen::OuterStride<>(m)) -=
            solve::matrix_of(p, d_.numbers);
        continue;
      }
      const MatrixXd& W = block(s.node).modal->W;
      for (Index row = 0; row < p.rows; ++row)
        for (Index j = 0; j < s.columns; ++j) to[row * m + j] -= p.sign * W(j, p.row + row);
    }
  }

  /// Rows of xdot that targets have.
  std::vector<Writing::IndexRange> rows_of_states() const {
    std::vector<Writing::IndexRange> rows;
    for (const Writing::Target& t : w_->targets)
      if (t.row < states_) Writing::add_range(rows, {t.row - t.still, t.rows + t.still});
    return rows;
  }

  /// The columns of these sources from the values of their solutions.
  void write_columns(std::size_t batch, Room& room) {
    room.state.clear(), room.output.clear();
    for (std::size_t i = w_->batches[batch]; i < w_->batches[batch + 1]; ++i) {
      const Writing::Source& s = w_->sources[i];
      for (Index j = 0; j < s.columns; ++j) {
        MatrixXd &state = s.node < 0 ? m_.B : m_.A, &output = s.node < 0 ? m_.D : m_.C;
        const Index column = (s.node < 0 ? s.first - states_ : s.first) + j;
        room.state.push_back(column_of(state, column, s, j));
        room.output.push_back(column_of(output, column, s, j));
      }
    }
    const auto count = static_cast<Index>(room.state.size());
    const double* const values = room.values.data();
    for (const Writing::IndexRange& r : rows_of_states())
      solve::scale_transposed(r.size, count, values + r.first * width_, width_, room.state.data(),
                              r.first);
    solve::scale_transposed(rows_ - states_, count, values + states_ * width_, width_,
                            room.output.data(), 0);
    for (std::size_t i = w_->batches[batch]; i < w_->batches[batch + 1]; ++i)
      if (w_->sources[i].node >= 0) add_own(w_->sources[i]);
  }

  /// Destination of the result of the j-th force or state of a source. A modal force belongs to the
  /// mode's coordinate and to its rate.
  solve::Destination column_of(MatrixXd& matrix, Index column, const Writing::Source& s,
                               Index j) const {
    double* const first = matrix.data() + column * matrix.rows();
    if (!s.modal) return {first};
    const Modal& modal = *block(s.node).modal;
    return {first, -modal.stiffness(j), first + s.columns * matrix.rows(), -modal.damping(j)};
  }

  /// The block's own A, with all its inputs at 0.
  void add_own(const Writing::Source& s) {
    const Dynamics& b = block(s.node);
    if (!b.modal) {
      m_.A.block(s.first, s.first, b.A.rows(), b.A.cols()) += b.A;
      return;
    }
    const Index n = b.modal->W.rows();
    for (Index i = 0; i < n; ++i) {
      m_.A(s.first + i, s.first + n + i) = 1;
      m_.A(s.first + n + i, s.first + i) -= b.modal->stiffness(i);
      m_.A(s.first + n + i, s.first + n + i) -= b.modal->damping(i);
    }
  }

  const Factored& d_;
  const Skeleton& k_;
  StateSpace& m_;
  std::shared_ptr<const Writing> w_;
  Index states_;
  Index rows_;       ///< of [xdot; y]
  Index width_ = 0;  ///< columns of the widest batch: from row to row of values
  int threads_;
};

}  // namespace

void write_dense(const Factored& data, StateSpace& model, int threads) {
  DenseWriter(data, model, threads).write();
  const std::vector<int> rates = rates_of(data.graph(), data.layout(), model.A);
  model.rates.resize(rates.size());
  for (std::size_t i = 0; i < rates.size(); ++i)
    if (rates[i] < 0)
      model.rates[i].clear();
    else
      model.rates[i] = model.states[at(rates[i])];
  data.states.reduce(model);
}

}  // namespace titop::detail
