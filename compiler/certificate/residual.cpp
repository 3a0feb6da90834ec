#include <algorithm>
#include <array>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <optional>
#include <span>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/surroundings.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {
namespace {

using Eigen::MatrixXd;
using linalg::at;

/// Values of a signal, and a sample of their rounding if it is known.
struct SignalValues {
  std::span<const double> value, rounding = {};
};

/// One equation after the other: left - right, and the sums of magnitudes, row by row.
struct EquationResidual {
  struct RowResidual {
    double difference = 0, magnitude = 0, rounding = 0;
    /// The part that rounding does not explain.
    double off() const {
      const double explained = std::isfinite(rounding) ? linalg::kNoise * rounding : 0;
      return std::max(std::abs(difference) - explained, 0.0);
    }
  };
  boost::container::small_vector<RowResidual, 8> row = {};
  const MatrixXd* part = nullptr;  ///< rows of the target; none: all of it
  int unit = 1;                    ///< entries of the target that share one; 0: not distinguished
  bool known = true;

  void start(Eigen::Index rows, int of_target, const MatrixXd* part_of_target = nullptr) {
    row.assign(at(rows), RowResidual());
    unit = of_target;
    part = part_of_target;
    known = true;
  }
  std::size_t rows() const { return row.size(); }
  /// The target's entry that row i is about.
  Eigen::Index entry(std::size_t i) const {
    auto e = static_cast<Eigen::Index>(i);
    if (part) part->row(e).cwiseAbs().maxCoeff(&e);
    return e;
  }

  /// factor * c * value. Entries that share a unit count by the largest of them: a 0 in one frame
  /// is rounding in another.
  template <class Matrix>
  void add(const Matrix& c, const SignalValues& x, int shared, double factor) {
    if (shared == 1 && rows() == 1 && x.rounding.empty()) {  // scalar diagrams: hardly any others
      RowResidual sum;
      for (std::size_t j = 0; j < x.value.size(); ++j) {
        const double by = c(0, static_cast<Eigen::Index>(j)) * factor * x.value[j];
        sum.difference += by, sum.magnitude += std::abs(by);
      }
      return add(0, sum, 1);
    }
    for (std::size_t j = 0; j < x.value.size(); ++j) {
      const RowResidual term = entry_of(x, j, shared);
      if (term.magnitude == 0 && term.difference == 0 && term.rounding == 0)
        continue;  // not a number is neither
      for (std::size_t i = 0; i < rows(); ++i)
        add(i, term, factor * c(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
  }
  void add_identity(const SignalValues& x, int shared, double factor) {
    for (std::size_t i = 0; i < rows(); ++i)
      add(i, entry_of(x, i, rows() == 1 ? 1 : shared), factor);
  }
  void add(std::size_t i, const RowResidual& term, double factor) {
    row[i].difference += factor * term.difference;
    row[i].magnitude += std::abs(factor) * term.magnitude;
    row[i].rounding += std::abs(factor) * term.rounding;
  }
  static RowResidual entry_of(const SignalValues& x, std::size_t j, int shared) {
    return {x.value[j], largest_with(x.value, j, shared),
            x.rounding.empty() ? 0 : largest_with(x.rounding, j, shared)};
  }
  static double largest_with(std::span<const double> list, std::size_t j, int shared) {
    if (shared == 1) return std::abs(list[j]);
    double largest = 0;
    for (const double x : list.subspan(j / at(shared) * at(shared), at(shared)))
      largest = std::max(largest, std::abs(x));
    return largest;
  }

  /// Largest difference beyond rounding; infinite if something is not finite.
  double largest() const {
    double size = 0;
    for (const RowResidual& r : row) {
      if (!std::isfinite(r.difference)) return HUGE_VAL;
      size = std::max(size, r.off());
    }
    return size;
  }
  /// Largest share of the rows of one unit; 1 if something is not finite.
  double relative() const {
    if (largest() == HUGE_VAL) return 1;
    if (rows() == 1) return row[0].off() == 0 ? 0 : row[0].off() / row[0].magnitude;
    double worst = 0;
    for (std::size_t i = 0; i < rows();) {
      const std::size_t first = i;
      double off = 0, size = 0;
      do {
        off = std::max(off, row[i].off());
        size = std::max(size, row[i].magnitude);
      } while (++i < rows() && same_unit(first, i));
      if (off > 0) worst = std::max(worst, off / size);
    }
    return worst;
  }
  bool same_unit(std::size_t i, std::size_t k) const {
    return unit == 0 || (unit > 1 && entry(i) / unit == entry(k) / unit);
  }
};

/// The residual of the equations as the user wrote them.
struct Residual {
  const Factored& d;
  const Signals& at_hand;
  const Graph& w = *d.skeleton->stage.source;
  Surroundings around{d, at_hand.unknowns};
  EquationResidual b = {};             ///< of the present equation
  std::array<double, 4> largest = {};  ///< see find_largest()
  double worst = 0;
  std::string where = {};

  SignalValues of(int signal) const {
    const int first = at_hand.first[at(signal)];
    const std::size_t count = at(at_hand.first[at(signal) + 1] - first);
    SignalValues result{{at_hand.values.data() + first, count}};
    if (at_hand.rounding.size() > 0) result.rounding = {at_hand.rounding.data() + first, count};
    return result;
  }
  /// Computed: active, or external, or at rest because no input moves it.
  bool known(int signal) const {
    const Signal& s = d.graph().signals[at(signal)];
    return s.active || s.role == Signal::Role::external;
  }

  /// The equation for this signal (-1: states) is complete. `name()` is only called if it is
  /// needed. A signal that is 0 up to rounding (a gain of 0, a pinned point) or underflow (far down
  /// a long chain) does not count.
  template <class Name>
  void take(int signal, Name name) {
    if (!b.known) return;
    const double r = b.relative();
    if (r <= worst) return;
    const double off = b.largest();
    if (off < kUnderflow) return;
    if (r > kEnough && off < HUGE_VAL && signal >= 0 && only_rounding(signal)) return;
    worst = r, where = name();
  }
  bool only_rounding(int signal) {
    for (std::size_t i = 0; i < b.rows(); ++i)
      if (const double off = b.row[i].off();
          off > kEnough * b.row[i].magnitude &&
          off > kLeftOfZero * around.size(signal, b.entry(i)) &&
          !(off <= kProductRounding * size_of_kind(signal, b.entry(i))))
        return false;
    return true;
  }

  /// Translations and rotations of points, forces and torques there. Other signals share no unit.
  std::optional<std::size_t> kind(int signal, Eigen::Index entry) const {
    const Signal& s = w.signals[at(signal)];
    if (s.channel < 0 || unit(signal) != 3) return {};
    const std::size_t of = w.channels[at(s.channel)].force == signal ? 1 : 0;
    return 2 * of + at(entry / 3);
  }
  double size_of_kind(int signal, Eigen::Index entry) const {
    const auto k = kind(signal, entry);
    return k ? largest[*k] : 0;
  }
  /// In over-constrained chains a motion or wrench that is exactly 0 is computed as rounding of the
  /// largest one of its kind, and so may be all terms of its equation: a residual at that level
  /// does not count.
  void find_largest() {
    if (d.skeleton->stage.released.empty()) return;
    for (int signal = 0; signal < static_cast<int>(w.signals.size()); ++signal)
      if (known(signal))
        for (Eigen::Index i = 0; const double x : of(signal).value)
          if (const auto k = kind(signal, i++); k && std::abs(x) > largest[*k])
            largest[*k] = std::abs(x);
  }

  int unit(int signal) const { return entries_per_unit(w.signals[at(signal)]); }

  /// Begins with these rows of the signal, or with all of it.
  void start(int signal, const MatrixXd* part) {
    b.start(part ? part->rows() : w.signals[at(signal)].size, unit(signal), part);
    b.known = known(signal);
    if (part)
      b.add(*part, of(signal), unit(signal), 1);
    else
      b.add_identity(of(signal), unit(signal), 1);
  }

  /// Subtracts N * (term); N = nullptr: the identity.
  void subtract(const MatrixXd* N, const Term& t, const Drives& drive) {
    b.known = b.known && known(t.signal);
    // Positions beyond an opened parameter have inputs of their own: no integrals of accelerations.
    if (t.of == Term::Of::position || t.of == Term::Of::rate)
      b.known = b.known && d.skeleton->stage.opened.empty();
    const double factor = t.of == Term::Of::position ? -1.0 / (at_hand.s * at_hand.s)
                          : t.of == Term::Of::rate   ? -1.0 / at_hand.s
                                                     : -1.0;
    const int channel = w.signals[at(t.signal)].channel;
    const bool less = t.of == Term::Of::reaction && !drive[at(channel)].added.empty();
    if (!N && t.factors.empty() && !less)
      return b.add_identity(of(t.signal), unit(t.signal), t.sign * factor);
    MatrixXd c = coefficient(w, t, d.numbers.parameters);
    if (N) c = *N * c;
    b.add(c, of(t.signal), unit(t.signal), factor);
    if (!less) return;
    c = -c;
    for (const int e : drive[at(channel)].added) subtract_force(&c, e, drive);
  }

  void subtract_force(const MatrixXd* N, int e, const Drives& drive) {
    const Equation& q = w.equations[at(e)];
    if (q.part.whole()) {
      for (const Term& t : q.terms) subtract(N, t, drive);
      return;
    }
    const MatrixXd f = N ? MatrixXd(*N * q.part.rows().transpose()) : q.part.rows().transpose();
    for (const Term& t : q.terms) subtract(&f, t, drive);
  }

  void accel(int channel, int e, const Drives& drive) {
    const Channel& c = w.channels[at(channel)];
    const Equation& q = w.equations[at(e)];
    start(c.accel, q.part.whole() ? nullptr : &q.part.rows());
    for (const Term& t : q.terms) subtract(nullptr, t, drive);
    take(c.accel, [&] { return print(w, q); });
  }

  void force(int channel, const Drives& drive) {
    const Channel& c = w.channels[at(channel)];
    const Drive& own = drive[at(channel)];
    if (own.free == 0) return;
    const MatrixXd* const N = own.all_free() ? nullptr : &own.some;
    start(c.force, N);
    for (const auto* list : {&own.force, &own.added})
      for (const int e : *list) subtract_force(N, e, drive);
    take(c.force, [&] { return "the forces at " + channel_name(w, channel); });
  }

  void equations() {
    const auto& kept = d.skeleton->stage.drives;
    const auto all = kept ? kept : std::make_shared<const Drives>(w);
    const Drives& drive = *all;
    for (int c = 0; c < static_cast<int>(drive.size()); ++c) {
      for (const int e : drive[at(c)].accel) accel(c, e, drive);
      force(c, drive);
    }
    for (const Equation& q : w.equations) {
      if (w.signals[at(q.target)].channel >= 0) continue;
      start(q.target, nullptr);
      for (const Term& t : q.terms) subtract(nullptr, t, drive);
      take(q.target, [&] { return print(w, q); });
    }
  }

  /// Subtracts matrix * (inputs of the node). Coefficients of unknown inputs must be 0.
  void subtract_inputs(const Node& node, int end, const MatrixXd& matrix, Eigen::Index row) {
    for (int i = node.first_signal; i < end; ++i) {
      const Signal& u = w.signals[at(i)];
      if (u.role != Signal::Role::input) continue;
      const auto c = matrix.block(row, u.first, static_cast<Eigen::Index>(b.rows()), u.size);
      b.known = b.known && (known(i) || c.isZero(0));
      b.add(c, of(i), unit(i), -1);
    }
  }

  /// s x = A x + B u
  void states(const Node& node, const Dynamics& m, int end) {
    b.start(m.A.rows(), 0);
    b.add_identity(of(node.state), 1, at_hand.s);
    b.add(m.A, of(node.state), 1, -1);
    subtract_inputs(node, end, m.B, 0);
    take(-1, [&] { return "the states of " + node.name; });
  }

  /// y = C x + D u
  void output(const Node& node, int index, const Dynamics& m, int end, int o) {
    const Signal& y = w.signals[at(o)];
    start(o, nullptr);
    if (node.state >= 0) {
      const auto C = m.C.middleRows(y.first, y.size);
      b.known = b.known && (known(node.state) || C.isZero(0));
      b.add(C, of(node.state), 1, -1);
    }
    if (closed_form_of(*node.block)) {
      const auto Y = response<double>(*node.block, m, at_hand.s, d.numbers.parameters).Y;
      subtract_inputs(node, end, Y, y.first);
    } else if (m.sparse.empty()) {
      subtract_inputs(node, end, m.D, y.first);
    }
    for (const Gains& part : m.gains_of_row(y.first)) {
      const int i = input_signal(w, index, part.column);
      b.known = b.known && known(i);
      b.add(part.gain, of(i), unit(i), -1);
    }
    take(o, [&] { return name_of(w, o); });
  }

  void blocks() {
    for (int index = 0; index < static_cast<int>(w.nodes.size()); ++index) {
      const Node& node = w.nodes[at(index)];
      const Dynamics& m = *d.numbers.blocks[at(index)];
      const int end = end_signal(w, index);
      if (node.state >= 0 && known(node.state) && at_hand.s != 0) states(node, m, end);
      for (int o = node.first_signal; o < end; ++o)
        if (w.signals[at(o)].role == Signal::Role::output && known(o))
          output(node, index, m, end, o);
    }
  }
};

}  // namespace

std::vector<int> first_of_signals(const Graph& graph) {
  std::vector<int> first = {0};
  first.reserve(graph.signals.size() + 1);
  for (const Signal& s : graph.signals) first.push_back(first.back() + s.size);
  return first;
}

WrittenResidual written_residual(const Factored& d, const Signals& signals) {
  Residual r{d, signals};
  if (signals.rounding.size() > 0) r.find_largest();
  r.equations();
  r.blocks();
  return {r.worst, r.where};
}

}  // namespace titop::detail
