#include <algorithm>
#include <numeric>
#include <titop/compiler/parallel.hpp>
#include <titop/compiler/solve/piece_matrix.hpp>
#include <titop/compiler/solve/products.hpp>
#include <titop/compiler/solve/propagation.hpp>
#include <titop/compiler/system_data.hpp>

/// The dense model from the factors. Every column of A and B answers one state or input that acts
/// on some rows of the joint system (a source); every row of xdot and y reads some unknowns (a
/// target). A body with N modes acts through its N modal forces, not its 2 N states: half the
/// columns.
namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using solve::Piece;
using solve::RowMatrix;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// What acts on the rows of the joint system.
struct Source {
  int node = -1;      ///< of a state; -1: external inputs
  Index first = 0;    ///< first column in [x; u]
  Index columns = 0;  ///< modes where it acts through its modes, else states or inputs
  const Modal* modal = nullptr;
  std::vector<int> rows;    ///< row groups
  std::vector<MatrixXd> c;  ///< right-hand sides, one matrix per row group
  int front = 0;            ///< the first front it enters
};

/// Rows of xdot or y: sum of E * (unknowns of a variable) and of known terms.
struct Target {
  struct Part {
    Index first = 0;  ///< of the unknowns, or of [x; u]
    RowMatrix<double> E;
    RowMatrix<double> Et = {};  ///< transposed, with columns of zeros up to Target::padded
  };
  Index row = 0;  ///< first row of [xdot; y]
  Index rows = 0;
  Index padded = 0;  ///< rows, up to a multiple of 4
  std::vector<Part> unknown, known;
};

/// Room for solutions. A thread keeps it from model to model while it is small: fresh memory would
/// cost as much as the work.
struct Room {
  solve::Propagation::Space space;
  std::vector<double> values;  ///< of the columns of a batch, one after the other
};
Room& room_of_thread() {
  static thread_local Room room;
  return room;
}
constexpr std::size_t kKeep = 1 << 17;  ///< numbers: 1 MB each of four

class Writer {
 public:
  Writer(const SystemData& d, StateSpace& m, int threads)
      : d_(d),
        k_(*d.skeleton),
        g_(d.graph()),
        m_(m),
        states_(d.layout().order()),
        first_output_((states_ + kPad + 7) / 8 * 8),
        values_(first_output_ + static_cast<Index>(d.layout().outputs.size()) + kPad),
        threads_(threads) {}

  void write() {
    shape();
    find_sources();
    find_targets();
    const solve::Propagation propagation(*d_.factors);
    const std::vector<std::size_t> begin = batches();
    Index most = 0;
    for (std::size_t i = 0; i + 1 < begin.size(); ++i)
      most = std::max(most, width(begin[i], begin[i + 1]));
    parallel(begin.size() - 1, threads(begin.size() - 1), [&] {
      Room& room = room_of_thread();
      room.values.assign(at(values_ * most), 0);
      return [this, &propagation, &begin, &room](std::size_t i) {
        columns(propagation, begin[i], begin[i + 1], room);
      };
    });
    if (room_of_thread().space.z.size() > kKeep) room_of_thread() = {};
    add_known();
    for (const int i : d_.layout().state_nodes) add_own(i);
  }

 private:
  static constexpr Index kBatch = 48;  ///< columns at a time
  static constexpr Index kPad = 3;     ///< what Target::padded may add

  /// A thread costs more to start than a small model to write.
  int threads(std::size_t batches) const {
    constexpr double kWorthIt = 1.5e5;  // entries of the solutions, about 2 ns each
    const double entries = static_cast<double>(batches) * kBatch * k_.joint.plan->unknowns;
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

  // --- sources ---------------------------------------------------------------------------------

  void find_sources() {
    std::vector<int> source_of(g_.signals.size(), -1);
    for (const int i : d_.layout().state_nodes) {
      const int x = g_.nodes[at(i)].state;
      source_of[at(x)] = static_cast<int>(sources_.size());
      sources_.push_back({i,
                          d_.layout().known_first[at(x)],
                          g_.signals[at(x)].size,
                          block(i).modal.get(),
                          {},
                          {},
                          0});
    }
    for (const Input& in : g_.inputs) {
      source_of[at(in.signal)] = static_cast<int>(sources_.size());
      sources_.push_back({-1, d_.layout().known_first[at(in.signal)], in.size, nullptr, {}, {}, 0});
    }
    // A body whose states are also read by equations acts through all of them.
    for (const Piece& p : k_.joint.pieces)
      if (p.entry < 0 && p.of != Piece::Left::state)
        sources_[at(source_of[at(p.signal)])].modal = nullptr;
    for (Source& s : sources_)
      if (s.modal) s.columns = s.modal->W.rows();
    for (int r = 0; r < static_cast<int>(k_.joint.rows.size()); ++r)
      for (const Piece& p : k_.joint.row(r))
        if (p.entry < 0) act(sources_[at(source_of[at(p.signal)])], r, p);
    for (Source& s : sources_) {
      s.front = static_cast<int>(k_.joint.plan->fronts.size());
      for (const int r : s.rows) s.front = std::min(s.front, k_.joint.plan->front_of_row[at(r)]);
    }
    std::stable_sort(sources_.begin(), sources_.end(),
                     [](const Source& a, const Source& b) { return a.front < b.front; });
  }

  void act(Source& s, int r, const Piece& p) const {
    MatrixXd c = s.modal ? MatrixXd(-p.sign * s.modal->W.middleCols(p.row, p.rows).transpose())
                         : MatrixXd(-solve::matrix_of(p, g_, d_.numbers));
    if (!s.rows.empty() && s.rows.back() == r) {
      s.c.back() += c;
      return;
    }
    s.rows.push_back(r);
    s.c.push_back(std::move(c));
  }

  // --- targets ---------------------------------------------------------------------------------

  void find_targets() {
    for (const int i : d_.layout().state_nodes) {
      const Node& node = g_.nodes[at(i)];
      const Dynamics& b = block(i);
      // Coordinates move with their rates, whatever acts: no input enters their rows.
      const Index still = b.modal ? b.modal->W.rows() : 0;
      Target t;
      t.row = d_.layout().state_first[at(i)] + still;
      t.rows = b.A.rows() - still;
      for (int s = node.first_signal; s < node.state; ++s)
        if (const Signal& in = g_.signals[at(s)]; in.role == Signal::Role::input && in.active)
          read(t, s, b.B.block(still, in.first, t.rows, in.size));
      add(std::move(t));
    }
    for (std::size_t o = 0; o < g_.outputs.size(); ++o) {
      Target t;
      t.row = states_ + d_.layout().output_first[o];
      t.rows = g_.outputs[o].size;
      const auto& terms = g_.outputs[o].terms;
      for (std::size_t n = 0; n < terms.size(); ++n)
        read(t, terms[n].signal, coefficient(k_.joint.output_coefficient[o] + static_cast<int>(n)));
      add(std::move(t));
    }
    std::sort(targets_.begin(), targets_.end(),
              [](const Target& a, const Target& b) { return a.row < b.row; });
  }

  void add(Target t) {
    join_neighbours(t);
    t.padded = (t.rows + kPad) / 4 * 4;
    for (Target::Part& p : t.unknown) {
      p.Et = RowMatrix<double>::Zero(p.E.cols(), t.padded);
      p.Et.leftCols(t.rows) = p.E.transpose();
    }
    targets_.push_back(std::move(t));
  }

  void read(Target& t, int signal, const MatrixXd& factor) const {
    for (const solve::Meaning& m : k_.joint.meaning(signal)) {
      const int v = k_.joint.variable_of[at(m.signal)];
      auto& parts = v >= 0 ? t.unknown : t.known;
      const Index first =
          v >= 0 ? k_.joint.plan->first[at(v)] : d_.layout().known_first[at(m.signal)];
      const RowMatrix<double> E = m.coefficient < 0
                                      ? RowMatrix<double>(factor)
                                      : RowMatrix<double>(factor * coefficient(m.coefficient));
      const auto same = std::find_if(parts.begin(), parts.end(),
                                     [&](const Target::Part& p) { return p.first == first; });
      if (same != parts.end())
        same->E += E;
      else
        parts.push_back({first, E, {}});
    }
  }

  /// Parts that read neighbours among the unknowns become one.
  static void join_neighbours(Target& t) {
    std::sort(t.unknown.begin(), t.unknown.end(),
              [](const Target::Part& a, const Target::Part& b) { return a.first < b.first; });
    std::vector<Target::Part> joined;
    for (Target::Part& p : t.unknown) {
      if (joined.empty() || joined.back().first + joined.back().E.cols() != p.first) {
        joined.push_back(std::move(p));
        continue;
      }
      RowMatrix<double> both(p.E.rows(), joined.back().E.cols() + p.E.cols());
      both << joined.back().E, p.E;
      joined.back().E = std::move(both);
    }
    t.unknown = std::move(joined);
  }

  // --- columns ---------------------------------------------------------------------------------

  /// First sources of the batches, and the end.
  std::vector<std::size_t> batches() const {
    std::vector<std::size_t> begin;
    Index columns = kBatch;
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      if (columns + sources_[i].columns > kBatch) begin.push_back(i), columns = 0;
      columns += sources_[i].columns;
    }
    begin.push_back(sources_.size());
    return begin;
  }

  /// Columns of these sources, up to a multiple of 8: no sum depends on their number.
  Index width(std::size_t begin, std::size_t end) const {
    Index m = 0;
    for (std::size_t i = begin; i < end; ++i) m += sources_[i].columns;
    return (m + 7) / 8 * 8;
  }

  /// Place of a row of [xdot; y] among the values of a column.
  Index place(Index row) const { return row < states_ ? row : first_output_ + row - states_; }

  /// Solves for these sources and writes their columns. Values stand as in the model; what no
  /// target has is 0 and stays so. A target's padding is 0, too, where it does not end in the rows
  /// of the next, which writes them later.
  void columns(const solve::Propagation& propagation, std::size_t begin, std::size_t end,
               Room& room) {
    auto& [space, values] = room;
    const Index m = width(begin, end);
    std::vector<int> rows;
    std::vector<double> rhs;
    Index first = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Source& s = sources_[i];
      for (std::size_t r = 0; r < s.rows.size(); ++r) {
        rows.push_back(s.rows[r]);
        const std::size_t old = rhs.size();
        rhs.resize(old + at(s.c[r].rows() * m), 0);
        for (Index row = 0; row < s.c[r].rows(); ++row)
          for (Index j = 0; j < s.columns; ++j) rhs[old + at(row * m + first + j)] = s.c[r](row, j);
      }
      first += s.columns;
    }
    propagation.solve(rows, rhs, m, space);
    for (const Target& t : targets_)
      for (const Target::Part& p : t.unknown)
        solve::multiply_transposed(t.padded, p.E.cols(), m, p.Et.data(),
                                   space.z.data() + p.first * m, values.data() + place(t.row),
                                   values_, &p != t.unknown.data());
    write_columns(begin, end, values.data());
  }

  /// The columns of these sources from the values of their solutions.
  void write_columns(std::size_t begin, std::size_t end, const double* values) {
    const auto write = [&](MatrixXd& state, MatrixXd& output, Index column, double factor) {
      solve::scale(state.rows(), factor, values, state.data() + column * state.rows());
      solve::scale(output.rows(), factor, values + first_output_,
                   output.data() + column * output.rows());
    };
    for (std::size_t i = begin; i < end; ++i) {
      const Source& s = sources_[i];
      for (Index j = 0; j < s.columns; ++j, values += values_)
        if (s.modal) {
          write(m_.A, m_.C, s.first + j, -s.modal->stiffness(j));
          write(m_.A, m_.C, s.first + s.columns + j, -s.modal->damping(j));
        } else if (s.node >= 0) {
          write(m_.A, m_.C, s.first + j, 1);
        } else {
          write(m_.B, m_.D, s.first - states_ + j, 1);
        }
    }
  }

  void add_known() {
    for (const Target& t : targets_) {
      const bool state = t.row < states_;
      const Index row = state ? t.row : t.row - states_;
      for (const Target::Part& p : t.known)
        if (p.first < states_)
          (state ? m_.A : m_.C).block(row, p.first, t.rows, p.E.cols()) += p.E;
        else
          (state ? m_.B : m_.D).block(row, p.first - states_, t.rows, p.E.cols()) += p.E;
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
  Index states_;
  Index first_output_;  ///< of a column's values
  Index values_;        ///< per column: [xdot; y], each with room for padding
  std::vector<Source> sources_;
  std::vector<Target> targets_;  ///< rows ascend
  int threads_;
};

}  // namespace

void write_dense(const SystemData& data, StateSpace& model, int threads) {
  Writer(data, model, threads).write();
  data.states.reduce(model);
}

}  // namespace titop::detail
