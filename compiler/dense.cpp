#include <algorithm>
#include <atomic>
#include <latch>
#include <titop/compiler/dense/writing.hpp>
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

/// Room for the solutions of one thread.
struct Room {
  solve::Propagation::Space space;
  std::vector<double> values;        ///< of the columns of a batch, one after the other
  std::vector<const double*> reads;  ///< rows of unknowns that a target reads
};

/// What a thread that writes models keeps from one to the next while it is small, for itself and
/// for those that it starts: fresh memory would cost as much as the work.
struct Kept {
  std::vector<double> coefficients, products;  ///< all threads read them
  std::vector<Room> rooms;

  bool is_large() const {
    constexpr std::size_t kKeep = 1 << 17;  // numbers: 1 MB each
    const auto large = [](const std::vector<double>& v) { return v.size() > kKeep; };
    return large(coefficients) || large(products) || rooms.size() > 8 ||
           std::any_of(rooms.begin(), rooms.end(), [&](const Room& room) {
             return large(room.values) || large(room.space.z) || large(room.space.carried);
           });
  }
};
Kept& kept_by_thread() {
  static thread_local Kept kept;
  return kept;
}

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
        g_(d.graph()),
        m_(m),
        w_(writing_of(d)),
        states_(d.layout().order()),
        first_output_((states_ + kPad + 7) / 8 * 8),
        values_(first_output_ + static_cast<Index>(d.layout().outputs.size()) + kPad),
        threads_(threads) {}

  void write() {
    shape();
    Kept& kept = kept_by_thread();
    solve::Propagation propagation(*d_.factors, kept.products);
    const std::size_t batches = w_->batches.size() - 1;
    Index most = 0;
    for (std::size_t i = 0; i < batches; ++i) most = std::max(most, w_->width(i));
    kept.coefficients.assign(at(w_->coefficients), 0);
    // What batches read are tasks, too: these are taken first, and all others wait for them.
    constexpr std::size_t kFirst = 2;
    std::latch first(kFirst);
    const std::size_t tasks = kFirst + batches;
    const int count = thread_count(threads(batches), tasks);
    kept.rooms.resize(std::max(kept.rooms.size(), at(count)));
    std::atomic<std::size_t> room{0};
    parallel(tasks, count, [&] {
      Room* const own = &kept.rooms[room++];
      return
          [this, &propagation, &kept, &first, most, own, cleared = false](std::size_t i) mutable {
            if (i >= kFirst) {
              if (!cleared) own->values.assign(at(values_ * most), 0);
              cleared = true;
              first.wait();
              return columns(propagation, kept.coefficients.data(), i - kFirst, *own);
            }
            const Done done{first};
            i == 0 ? propagation.form() : find_coefficients(kept.coefficients.data());
          };
    });
    if (kept.is_large()) kept = {};
    add_known();
    for (const int i : d_.layout().state_nodes) add_own(i);
  }

 private:
  static constexpr Index kPad = 3;  ///< what Target::padded may add

  /// A thread costs more to start than a small model to write.
  int threads(std::size_t batches) const {
    constexpr double kWorthIt = 1.5e5;  // entries of the solutions, about 2 ns each
    const double entries =
        static_cast<double>(batches * std::size_t{Writing::kBatch}) * k_.joint.plan->unknowns;
    return entries < kWorthIt ? 1 : threads_;
  }

  void shape() {
    const auto inputs = static_cast<Index>(d_.layout().inputs.size());
    const auto outputs = static_cast<Index>(d_.layout().outputs.size());
    m_.A.resize(states_, states_);
    m_.B.resize(states_, inputs);
    m_.C.resize(outputs, states_);
    m_.D.resize(outputs, inputs);
    m_.states = d_.layout().states;
    m_.inputs = d_.layout().inputs;
    m_.outputs = d_.layout().outputs;
  }

  const Dynamics& block(int node) const { return *d_.numbers.blocks[at(node)]; }
  const RowMatrix<double>& coefficient(int i) const { return *d_.numbers.coefficients[at(i)]; }

  // --- targets ---------------------------------------------------------------------------------

  /// to += factor * what it is multiplied by.
  template <class Factor, class To>
  void add_product(const Factor& factor, int times, To to) const {
    if (times < 0)
      to += factor;
    else
      to += factor.lazyProduct(coefficient(times));
  }
  template <class To>
  void add_term(const Writing::Target& t, const Writing::Term& term, To to) const {
    if (term.node >= 0)
      add_product(block(term.node).B.block(t.still, term.column, t.rows, term.size), term.times,
                  to);
    else
      add_product(coefficient(term.coefficient), term.times, to);
  }
  Index size(const Writing::Term& term) const {
    return term.times < 0 ? term.size : coefficient(term.times).cols();
  }

  /// `to`: zeros.
  void find_coefficients(double* to) const {
    for (const Writing::Target& t : w_->targets)
      for (const Writing::Term& term : t.terms)
        if (!term.known)
          add_term(t, term,
                   Eigen::Map<MatrixXd, 0, Eigen::OuterStride<>>(to + term.to, t.rows, size(term),
                                                                 Eigen::OuterStride<>(t.padded)));
  }

  void add_known() {
    for (const Writing::Target& t : w_->targets) {
      const bool state = t.row < states_;
      const Index row = state ? t.row : t.row - states_;
      for (const Writing::Term& term : t.terms) {
        if (!term.known) continue;
        const bool of_state = term.to < states_;
        MatrixXd& to = of_state ? (state ? m_.A : m_.C) : (state ? m_.B : m_.D);
        add_term(t, term,
                 to.block(row, of_state ? term.to : term.to - states_, t.rows, size(term)));
      }
    }
  }

  // --- columns ---------------------------------------------------------------------------------

  /// Place of a row of [xdot; y] among the values of a column.
  Index place(Index row) const { return row < states_ ? row : first_output_ + row - states_; }

  /// Solves for the sources of a batch and writes their columns. Values stand as in the model; what
  /// no target has is 0 and stays so. A target's padding is 0, too, where it does not end in the
  /// rows of the next, which writes them later.
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
    write_columns(batch, room.values.data());
  }

  /// The target's rows of all m columns.
  void read(const Writing::Target& t, const double* coefficients, Index m, Room& room) const {
    if (t.unknowns.empty()) return;
    room.reads.clear();
    for (const Writing::Range& r : t.unknowns)
      for (Index i = r.first; i < r.first + r.size; ++i)
        room.reads.push_back(room.space.z.data() + i * m);
    solve::multiply_transposed(t.padded, static_cast<Index>(room.reads.size()), m,
                               coefficients + t.coefficients, room.reads.data(),
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

  /// The columns of these sources from the values of their solutions.
  void write_columns(std::size_t batch, const double* values) {
    const auto write = [&](MatrixXd& state, MatrixXd& output, Index column, double factor) {
      solve::scale(state.rows(), factor, values, state.data() + column * state.rows());
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
    }
  }

  /// The block's own A: what it does with all its inputs at 0.
  void add_own(int node) {
    const Index first = d_.layout().state_first[at(node)];
    const Dynamics& b = block(node);
    if (!b.modal) {
      m_.A.block(first, first, b.A.rows(), b.A.cols()) += b.A;
      return;
    }
    const Index n = b.modal->W.rows();
    for (Index i = 0; i < n; ++i) {
      m_.A(first + i, first + n + i) = 1;
      m_.A(first + n + i, first + i) -= b.modal->stiffness(i);
      m_.A(first + n + i, first + n + i) -= b.modal->damping(i);
    }
  }

  const SystemData& d_;
  const Skeleton& k_;
  const Graph& g_;
  StateSpace& m_;
  std::shared_ptr<const Writing> w_;
  Index states_;
  Index first_output_;  ///< of a column's values
  Index values_;        ///< per column: [xdot; y], each with room for padding
  int threads_;
};

}  // namespace

void write_dense(const SystemData& data, StateSpace& model, int threads) {
  Writer(data, model, threads).write();
  data.states.reduce(model);
}

}  // namespace titop::detail
