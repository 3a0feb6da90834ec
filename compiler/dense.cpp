#include <algorithm>
#include <atomic>
#include <cmath>
#include <latch>
#include <titop/compiler/dense/kept.hpp>
#include <titop/compiler/dense/runs.hpp>
#include <titop/compiler/dense/terms.hpp>
#include <titop/compiler/dense/uneven.hpp>
#include <titop/compiler/parallel.hpp>
#include <titop/compiler/solve/piece_matrix.hpp>
#include <titop/compiler/solve/products.hpp>
#include <titop/compiler/solve/propagation.hpp>
#include <titop/compiler/system_data.hpp>

/// The dense model from the factors: what `Writing` says, in numbers.
namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using solve::RowMatrix;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Whoever waits goes on, even if this task has thrown: its numbers are not used then.
struct Done {
  std::latch& latch;
  ~Done() { latch.count_down(); }
};

class Writer {
 public:
  Writer(const SystemData& d, StateSpace& m, int threads)
      : d_(d),
        k_(*d.skeleton),
        m_(m),
        w_(writing_of(d)),
        half_(w_->reciprocity && w_->reciprocity->holds(d.numbers)),
        states_(d.layout().order()),
        first_output_((states_ + 7) / 8 * 8),
        values_(first_output_ + static_cast<Index>(d.layout().outputs.size())),
        threads_(threads) {}

  void write() {
    resize();
    Kept& kept = kept_by_thread();
    solve::Propagation propagation(*d_.factors, kept.products);
    const std::size_t batches = w_->batches.size() - 1;
    Index most = 0;
    for (std::size_t i = 0; i < batches; ++i) most = std::max(most, w_->width(i));
    kept.coefficients.assign(at(w_->coefficients), 0);
    // What batches read are tasks, too: these are taken first, and all others wait for them. Only
    // the last may throw: tasks behind one that throws are not begun, and all would wait for them.
    constexpr std::size_t kFirst = 4;
    std::latch first(kFirst);
    const auto prepare = [&](std::size_t i) {
      const Done done{first};
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
    std::vector<OwnTerms> own(batches);
    const auto write = [&](std::size_t batch, bool half, Room& room) {
      room.clear_for(w_, at(values_ * most));
      first.wait();
      own[batch] = columns(propagation, kept.coefficients.data(), batch, half, room);
    };
    std::atomic<std::size_t> next{0};
    parallel(tasks, count, [&] {
      return [this, &prepare, &write, &room = kept.rooms[next++]](std::size_t i) {
        i < kFirst ? prepare(i) : write(i - kFirst, half_, room);
      };
    });
    const auto uneven = half_ ? uneven_batches(*w_, own) : std::vector<std::size_t>();
    next = 0;
    parallel(uneven.size(), count, [&] {
      return [&uneven, &write, &room = kept.rooms[next++]](std::size_t i) {
        write(uneven[i], false, room);
      };
    });
    if (kept.is_large()) kept = {};
    add_known(d_, *w_, m_);
  }

 private:
  /// To wake a thread and wait for it takes longer than to write a small model.
  int threads(std::size_t batches) const {
    constexpr double kWorthIt = 5e4;  // entries of the solutions, about 2 ns each
    const double entries =
        static_cast<double>(batches * std::size_t{Writing::kBatch}) * k_.joint.plan->unknowns;
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

  /// Place of a row of [xdot; y] among the values of a column.
  Index place(Index row) const { return row < states_ ? row : first_output_ + row - states_; }

  /// Solves for the sources of a batch and writes their columns. Values stand as in the model; of
  /// rows that are not read they are those of another batch. Returns how much the modes of the
  /// sources are accelerated by forces of their own.
  OwnTerms columns(const solve::Propagation& propagation, const double* coefficients,
                   std::size_t batch, bool half, Room& room) {
    const Index m = w_->width(batch);
    propagation.begin(m, room.space);
    Index first = 0;
    for (std::size_t i = w_->batches[batch]; i < w_->batches[batch + 1]; ++i) {
      act(w_->sources[i], first, propagation, room.space);
      first += w_->sources[i].columns;
    }
    propagation.solve(room.space, half ? w_->lowest[batch] : 0, w_->always);
    for (const Writing::Target& t : w_->targets)
      if (reads(t, batch, half)) read(t, coefficients, m, room);
    write_columns(batch, half, room.values.data());
    if (half) write_rows(batch, room);
    return own_terms(batch, room.values.data());
  }

  /// False where other batches give what the target would read.
  bool reads(const Writing::Target& t, std::size_t batch, bool half) const {
    return !half || t.source < 0 || !w_->has_counterparts(batch) ||
           at(t.source) >= w_->batches[batch];
  }

  /// The target's rows of all m columns.
  void read(const Writing::Target& t, const double* coefficients, Index m, Room& room) const {
    if (t.unknowns.empty()) return;
    room.reads.clear();
    for (const Writing::Range& r : t.unknowns)
      for (Index i = r.first; i < r.first + r.size; ++i)
        room.reads.push_back(room.space.z.data() + i * m);
    solve::multiply_transposed(t.rows, static_cast<Index>(room.reads.size()), m,
                               coefficients + t.coefficients, t.padded, room.reads.data(),
                               room.values.data() + place(t.row), values_);
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

  /// Rows of xdot that targets of this batch have.
  std::vector<Run> rows_of(std::size_t batch, bool half) const {
    std::vector<Run> runs;
    for (const Writing::Target& t : w_->targets)
      if (t.row < states_ && reads(t, batch, half))
        add_run(runs, {t.row - t.still, t.rows + t.still, t.row - t.still});
    return runs;
  }

  /// The columns of these sources from the values of their solutions.
  void write_columns(std::size_t batch, bool half, const double* values) {
    const std::vector<Run> runs = rows_of(batch, half);
    const auto write = [&](MatrixXd& state, MatrixXd& output, Index column, double factor) {
      for (const Run& r : runs)
        solve::scale(r.size, factor, values + r.from, state.data() + column * state.rows() + r.row);
      solve::scale(output.rows(), factor, values + first_output_,
                   output.data() + column * output.rows());
    };
    for (std::size_t i = w_->batches[batch]; i < w_->batches[batch + 1]; ++i) {
      const Writing::Source& s = w_->sources[i];
      const Modal* const modal = s.modal ? block(s.node).modal.get() : nullptr;
      for (Index j = 0; j < s.columns; ++j, values += values_)
        if (modal) {
          write(m_.A, m_.C, s.first + j, -modal->stiffness(j));
          write(m_.A, m_.C, s.first + s.columns + j, -modal->damping(j));
        } else if (s.node >= 0) {
          write(m_.A, m_.C, s.first + j, 1);
        } else {
          write(m_.B, m_.D, s.first - states_ + j, 1);
        }
      if (s.node >= 0) add_own(s);
    }
  }

  /// What later targets read of these sources is what these sources' targets read of theirs.
  void write_rows(std::size_t batch, Room& room) {
    std::vector<Run> runs;
    Index width = 0;
    for (std::size_t i = w_->batches[batch]; i < w_->batches[batch + 1]; ++i) {
      const Writing::Source& s = w_->sources[i];
      if (!s.modal) continue;
      add_run(runs, {s.first, 2 * s.columns, width});
      width += 2 * s.columns;
    }
    room.across.clear();
    for (const Writing::Target& t : w_->targets) {
      if (t.source < 0 || at(t.source) < w_->batches[batch + 1]) continue;
      gather(t, batch, width, room);
      const Writing::Source& s = w_->sources[at(t.source)];
      const Modal& modal = *block(s.node).modal;
      for (Index j = 0; j < t.rows; ++j)
        for (const Run& r : runs) {
          const double* const from = room.across.data() + j * width + r.from;
          double* const to = m_.A.data() + (s.first + j) * states_ + r.row;
          solve::scale(r.size, -modal.stiffness(j), from, to);
          solve::scale(r.size, -modal.damping(j), from, to + s.columns * states_);
        }
    }
  }

  /// The target's rows of the batch's modal columns, each as the column of A that it is. Rows of
  /// coordinates are 0 and stay so.
  void gather(const Writing::Target& t, std::size_t batch, Index width, Room& room) const {
    if (room.across.size() < at(t.rows * width)) room.across.resize(at(t.rows * width), 0);
    const double* from = room.values.data() + place(t.row);
    double* to = room.across.data();
    for (std::size_t i = w_->batches[batch]; i < w_->batches[batch + 1]; ++i) {
      const Writing::Source& s = w_->sources[i];
      if (s.modal) {
        solve::transpose(s.columns, t.rows, from, values_, to + s.columns, width);
        to += 2 * s.columns;
      }
      from += s.columns * values_;
    }
  }

  OwnTerms own_terms(std::size_t batch, const double* values) const {
    OwnTerms result;
    for (std::size_t i = w_->batches[batch]; i < w_->batches[batch + 1]; ++i) {
      const Writing::Source& s = w_->sources[i];
      for (Index j = 0; j < s.columns; ++j, values += values_)
        if (s.modal) result.take(std::abs(1 + values[place(s.first + s.columns + j)]));
    }
    return result;
  }

  /// The block's own A: what it does with all its inputs at 0.
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

  const SystemData& d_;
  const Skeleton& k_;
  StateSpace& m_;
  std::shared_ptr<const Writing> w_;
  bool half_;  ///< half of a symmetric matrix is enough
  Index states_;
  Index first_output_;  ///< of a column's values
  Index values_;        ///< per column: [xdot; y]
  int threads_;
};

}  // namespace

void write_dense(const SystemData& data, StateSpace& model, int threads) {
  Writer(data, model, threads).write();
  data.states.reduce(model);
}

}  // namespace titop::detail
