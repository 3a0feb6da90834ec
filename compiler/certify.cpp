#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <titop/compiler/evaluate.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/compiler/system_data.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/dense.hpp>

namespace titop::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Numbers in [-1, 1] from a fixed seed: a certificate must be the same on every run.
class Numbers {
 public:
  double next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1.0;
  }

 private:
  unsigned long long state_ = 0x9E3779B97F4A7C15ull;
};

}  // namespace

std::complex<double> pick_s(const SystemData& d) {
  double log_sum = 0;
  int count = 0;
  for (const int i : d.layout().state_nodes) {
    const double size = std::sqrt(d.numbers.blocks[at(i)]->A.cwiseAbs().maxCoeff());
    if (size > 0 && std::isfinite(size)) log_sum += std::log(size), ++count;
    if (count >= 64) break;
  }
  const double w = count ? std::exp(log_sum / count) : 1;
  return {0.37 * w, 0.93 * w};
}

namespace {

using Complex = std::complex<double>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All signals at one s.
class Values {
 public:
  Values(const SystemData& d, const Evaluation<Complex>& point) : g_(d.graph()) {
    for (const Signal& s : g_.signals) first_.push_back(first_.back() + s.size);
    values_ = point.values(first_);
  }
  std::span<const Complex> of(int signal) const {
    return {values_.data() + first_[at(signal)], at(first_[at(signal) + 1] - first_[at(signal)])};
  }
  /// Computed: active, or external, or at rest because no input moves it.
  bool known(int signal) const {
    const Signal& s = g_.signals[at(signal)];
    return s.active || s.role == Signal::Role::external;
  }

 private:
  const Graph& g_;
  std::vector<int> first_ = {0};
  solve::RowMatrix<Complex> values_;
};

double largest_of(std::span<const Complex> values) {
  double largest = 0;
  for (const Complex& v : values) largest = std::max(largest, solve::size_of(v));
  return largest;
}

/// One equation after the other: left - right, and the sum of magnitudes, row by row.
struct Balance {
  std::vector<Complex> difference = {};
  std::vector<double> magnitude = {};
  bool known = true;

  void start(Eigen::Index rows, bool is_known) {
    difference.assign(static_cast<std::size_t>(rows), 0);
    magnitude.assign(static_cast<std::size_t>(rows), 0);
    known = is_known;
  }
  Eigen::Index rows() const { return static_cast<Eigen::Index>(difference.size()); }

  /// factor * c * value. A port signal counts by its largest entry: of a pinned point the
  /// translation is 0 but for rounding, which its rotation has left there. States count one by one.
  template <class Matrix>
  void add(const Matrix& c, std::span<const Complex> value, Complex factor, bool by_entry = false) {
    const double largest = by_entry ? 0 : largest_of(value), scale = solve::size_of(factor);
    for (Eigen::Index j = 0; j < c.cols(); ++j) {
      const Complex x = value[static_cast<std::size_t>(j)], v = factor * x;
      const double size = scale * (by_entry ? solve::size_of(x) : largest);
      for (Eigen::Index i = 0; i < c.rows(); ++i) {
        difference[static_cast<std::size_t>(i)] += c(i, j) * v;
        magnitude[static_cast<std::size_t>(i)] += std::abs(c(i, j)) * size;
      }
    }
  }
  void add_identity(std::span<const Complex> value, Complex factor, bool by_entry = false) {
    const double largest = by_entry ? 0 : largest_of(value), scale = solve::size_of(factor);
    for (std::size_t i = 0; i < value.size(); ++i) {
      difference[i] += factor * value[i];
      magnitude[i] += scale * (by_entry ? solve::size_of(value[i]) : largest);
    }
  }
  /// Largest difference; infinite where something is not finite.
  double largest() const {
    double result = 0;
    for (const Complex& v : difference) {
      const double size = solve::size_of(v);
      result = std::isfinite(size) ? std::max(result, size) : kInfinity;
      if (result == kInfinity) break;
    }
    return result;
  }
  /// 1 where something is not finite.
  double relative() const {
    const double off = largest();
    if (off == kInfinity) return 1;
    double size = 0;
    for (const double m : magnitude) size = std::max(size, m);
    return off > 0 ? off / size : 0;
  }
};

/// Size of a signal's neighbours in its front of the elimination, in the signal's own unit (both by
/// the scaling of the front's columns): what is 1e-16 of it is what rounding leaves of a 0.
double size_around(const SystemData& d, const Evaluation<Complex>& point, int signal) {
  const solve::Plan& plan = *d.skeleton->joint.plan;
  const solve::ColumnScale& scale = *d.factors->scale();
  double result = 0;
  for (const solve::Meaning& m : d.skeleton->joint.meaning(signal)) {
    const int v = d.skeleton->joint.variable_of[at(m.signal)];
    if (v < 0) continue;
    const auto front = std::prev(
        std::upper_bound(plan.fronts.begin(), plan.fronts.end(), plan.first[at(v)],
                         [](int place, const solve::Front& f) { return place < f.first_unknown; }));
    double largest = 0;
    int column = front->first_column, own = 0;
    for (const auto range : {front->pivots, front->border})
      for (const int other : plan.list(range)) {
        if (other == v) own = scale[at(column)];
        for (int i = 0; i < plan.structure.variable_size[at(other)]; ++i, ++column)
          largest = std::max(largest,
                             std::ldexp(solve::size_of(point.unknowns()(plan.first[at(other)] + i)),
                                        -scale[at(column)]));
      }
    result = std::max(result, std::ldexp(largest, own));
  }
  return result;
}

/// The residual of the equations as the user wrote them.
struct Residual {
  const SystemData& d;
  const Evaluation<Complex>& point;
  const Values& values;
  Complex s;
  const Graph& w = *d.skeleton->stage.source;
  Balance b = {};  ///< of the present equation
  double worst = 0;
  std::string where = {};

  /// The equation for this signal (-1: states) is complete. `name()` is only asked for where it is
  /// needed. A signal that is 0 but for rounding (a gain of 0, a pinned point) does not count.
  template <class Name>
  void take(int signal, Name name) {
    if (!b.known) return;
    const double r = b.relative();
    if (r <= worst) return;
    constexpr double kRounding = 1e-14;
    const double off = b.largest();
    if (r > kSuspicious && off < kInfinity && signal >= 0 &&
        off <= kRounding * size_around(d, point, signal))
      return;
    worst = r, where = name();
  }
  static constexpr double kSuspicious = 1e-9;

  /// Subtracts N * (term); N = nullptr: the identity.
  void subtract(const MatrixXd* N, const Term& t, const std::vector<Drive>& drive) {
    b.known = b.known && values.known(t.signal);
    MatrixXd c = coefficient(w, t, d.numbers.parameters);
    if (N) c = *N * c;
    b.add(c, values.of(t.signal),
          t.of == Term::Of::position ? -1.0 / (s * s)
          : t.of == Term::Of::rate   ? -1.0 / s
                                     : -1.0);
    if (t.of != Term::Of::reaction) return;
    const int channel = w.signals[at(t.signal)].channel;
    c = -c;
    for (const int e : drive[at(channel)].added) subtract_force(&c, e, drive);
  }

  void subtract_force(const MatrixXd* N, int e, const std::vector<Drive>& drive) {
    const Equation& q = w.equations[at(e)];
    if (q.part.whole()) {
      for (const Term& t : q.terms) subtract(N, t, drive);
      return;
    }
    const MatrixXd f = N ? MatrixXd(*N * q.part.rows.transpose()) : q.part.rows.transpose();
    for (const Term& t : q.terms) subtract(&f, t, drive);
  }

  void accel(int channel, int e, const std::vector<Drive>& drive) {
    const Channel& c = w.channels[at(channel)];
    const Equation& q = w.equations[at(e)];
    b.start(q.part.whole() ? c.size : q.part.rows.rows(), values.known(c.accel));
    if (q.part.whole())
      b.add_identity(values.of(c.accel), 1);
    else
      b.add(q.part.rows, values.of(c.accel), 1);
    for (const Term& t : q.terms) subtract(nullptr, t, drive);
    take(c.accel, [&] { return print(w, q); });
  }

  void force(int channel, const std::vector<Drive>& drive) {
    const Channel& c = w.channels[at(channel)];
    const Drive& own = drive[at(channel)];
    if (own.N.rows() == 0) return;
    const bool whole = own.N.rows() == c.size;  // N is the identity then
    b.start(own.N.rows(), values.known(c.force));
    if (whole)
      b.add_identity(values.of(c.force), 1);
    else
      b.add(own.N, values.of(c.force), 1);
    for (const auto* list : {&own.force, &own.added})
      for (const int e : *list) subtract_force(whole ? nullptr : &own.N, e, drive);
    take(c.force, [&] { return "the forces at " + channel_name(w, channel); });
  }

  void equations() {
    const auto& cached = d.skeleton->stage.drives;
    const std::vector<Drive> made = cached ? std::vector<Drive>{} : drives(w);
    const std::vector<Drive>& drive = cached ? *cached : made;
    for (int c = 0; c < static_cast<int>(drive.size()); ++c) {
      for (const int e : drive[at(c)].accel) accel(c, e, drive);
      force(c, drive);
    }
    for (const Equation& q : w.equations) {
      if (w.signals[at(q.target)].channel >= 0) continue;
      b.start(w.signals[at(q.target)].size, values.known(q.target));
      b.add_identity(values.of(q.target), 1);
      for (const Term& t : q.terms) subtract(nullptr, t, drive);
      take(q.target, [&] { return print(w, q); });
    }
  }

  /// Subtracts matrix * (inputs of the node). What is not known must not matter.
  void subtract_inputs(const Node& node, int end, const MatrixXd& matrix, Eigen::Index row) {
    for (int i = node.first_signal; i < end; ++i) {
      const Signal& u = w.signals[at(i)];
      if (u.role != Signal::Role::input) continue;
      const auto c = matrix.block(row, u.first, b.rows(), u.size);
      b.known = b.known && (values.known(i) || c.isZero(0));
      b.add(c, values.of(i), -1);
    }
  }

  /// s x = A x + B u
  void states(const Node& node, const Dynamics& m, int end) {
    b.start(m.A.rows(), true);
    b.add_identity(values.of(node.state), s, true);
    b.add(m.A, values.of(node.state), -1, true);
    subtract_inputs(node, end, m.B, 0);
    take(-1, [&] { return "the states of " + node.name; });
  }

  /// y = C x + D u
  void output(const Node& node, int index, const Dynamics& m, int end, int o) {
    const Signal& y = w.signals[at(o)];
    b.start(y.size, true);
    b.add_identity(values.of(o), 1);
    if (node.state >= 0) {
      const auto C = m.C.middleRows(y.first, y.size);
      b.known = b.known && (values.known(node.state) || C.isZero(0));
      b.add(C, values.of(node.state), -1, true);
    }
    if (m.sparse.empty()) subtract_inputs(node, end, m.D, y.first);
    for (const Gains& part : m.gains_of_row(y.first)) {
      const int i = input_signal(w, index, part.column);
      b.known = b.known && values.known(i);
      b.add(part.gain, values.of(i), -1);
    }
    take(o, [&] { return name_of(w, o); });
  }

  void blocks() {
    for (int index = 0; index < static_cast<int>(w.nodes.size()); ++index) {
      const Node& node = w.nodes[at(index)];
      const Dynamics& m = *d.numbers.blocks[at(index)];
      const int end = end_signal(w, index);
      if (node.state >= 0 && values.known(node.state)) states(node, m, end);
      for (int o = node.first_signal; o < end; ++o)
        if (w.signals[at(o)].role == Signal::Role::output && values.known(o))
          output(node, index, m, end, o);
    }
  }
};

constexpr double kWarn = 1e-9;  ///< what is worse than this is said in the log

/// At one s with one random input: how well the equations hold, and what rounding does to the
/// outputs. Where double has no digit left the residual is 1.
void self_check(const SystemData& d, Check& check) try {
  Certificate& certificate = check.certificate;
  Numbers random;
  solve::RowMatrix<std::complex<double>> u(static_cast<Eigen::Index>(d.layout().inputs.size()), 1);
  for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = {random.next(), random.next()};
  certificate.s = pick_s(d);
  if (u.size() == 0) return;  // nothing moves
  Evaluation<std::complex<double>> point(d, certificate.s, u);
  const Values values(d, point);
  Residual r{d, point, values, certificate.s};
  r.equations();
  r.blocks();
  certificate.residual = r.worst;
  certificate.residual_where = r.where;
  if (const double lost = std::max(point.improve(), point.rounding()); lost > kWarn)
    check.notes.push_back(
        {Note::Kind::warning, "certify",
         fmt::format(
             "in double the outputs are right to {:.1g} at s = {:.3g}{:+.3g}j: transfer takes "
             "finer arithmetic, apply and A, B, C, D have these digits only",
             lost, certificate.s.real(), certificate.s.imag())});
} catch (const Error& error) {
  if (!error.has(Code::singular)) throw;
  check.certificate.residual = 1;
  check.certificate.residual_where = "in double, not one equation";
}

/// The model's states block by block: first and count.
std::vector<std::pair<int, int>> segments(const SystemData& d) {
  std::vector<std::pair<int, int>> result;
  const std::vector<int>& kept = d.states.kept();
  for (const int i : d.layout().state_nodes) {
    const int begin = d.layout().state_first[at(i)],
              end = begin + static_cast<int>(d.numbers.blocks[at(i)]->A.rows());
    const auto first = std::lower_bound(kept.begin(), kept.end(), begin);
    result.emplace_back(first - kept.begin(), std::lower_bound(first, kept.end(), end) - first);
  }
  return result;
}

}  // namespace

double dense_difference(const SystemData& d, const StateSpace& m) {
  if (m.A.size() == 0) return 0;
  Numbers random;
  VectorXd x(m.A.rows()), u(m.B.cols());
  for (Eigen::Index i = 0; i < x.size(); ++i) x(i) = random.next();
  for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = random.next();
  const VectorXd all = d.states.expanded(x, u);
  solve::RowMatrix<double> known(all.size() + u.size(), 1);
  known << all, u;
  const Rates exact = rates(d, known);
  VectorXd off = d.states.kept_rows(VectorXd(exact.xdot)), size = VectorXd::Zero(x.size());
  for (const auto& [matrix, vector] : {std::pair(&m.A, &x), std::pair(&m.B, &u)})
    for (Eigen::Index j = 0; j < matrix->cols(); ++j) {  // once through memory
      off -= matrix->col(j) * (*vector)(j);
      size += matrix->col(j).cwiseAbs() * std::abs((*vector)(j));
    }
  double worst = 0;
  for (const auto& [first, n] : segments(d)) {
    if (n == 0) continue;
    const double largest = size.segment(first, n).maxCoeff();
    if (largest > 0) worst = std::max(worst, off.segment(first, n).cwiseAbs().maxCoeff() / largest);
  }
  return worst;
}

DenseError dense_error(const SystemData& d, const StateSpace& m) {
  using T = std::complex<double>;
  Numbers random;
  solve::RowMatrix<T> u(m.B.cols(), 1);
  for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = {random.next(), random.next()};
  DenseError worst;
  if (u.size() == 0 || m.C.rows() == 0 || m.A.size() == 0) return worst;
  for (const double factor : {1e-4, 1e-2, 1.0, 1e2}) {
    const T s = factor * d.checked().certificate.s;
    const Evaluation<T> point(d, s, u);
    const solve::RowMatrix<T> x = d.states.model_states(point.states(), u, s);
    VectorXcd left = -s * x;
    for (Eigen::Index j = 0; j < m.A.cols(); ++j) left += m.A.col(j) * x(j);
    left += m.B * u;
    const solve::RowMatrix<T> change = point.forced(d.states.expanded(solve::RowMatrix<T>(left))),
                              y = point.outputs();
    // What C itself costs in rounding is one product: below what is looked for here.
    const double error = change.cwiseAbs().maxCoeff() / y.cwiseAbs().maxCoeff();
    if (error > worst.error) worst = {error, s};
  }
  return worst;
}

namespace {

constexpr double kFewDigits = 1e-7;  ///< distance from singular at which 9 digits are left

/// "about 2 digits are": what a loop keeps at this distance from singular.
std::string digits_at(double distance) {
  const double digits = std::max(0.0, std::round(std::log10(distance / 1.1e-16)));
  return digits == 1 ? "about one digit is" : fmt::format("about {:.0f} digits are", digits);
}

std::string variable_name(const SystemData& d, int variable) {
  const int signal = d.skeleton->joint.variables[at(variable)];
  return signal < 0 ? "a sum of many terms" : name_of(d.graph(), signal);
}

}  // namespace

const Check& SystemData::checked() const {
  std::call_once(check_once, [&] { check = certify(*this); });
  return check;
}

Check certify(const SystemData& d) {
  const auto start = std::chrono::steady_clock::now();
  const solve::Health h = d.factors->health();
  Check check{{}, d.notes};
  Certificate& c = check.certificate;
  c.weakest_pivot = h.weakest;
  if (h.weakest_variable >= 0) c.weakest_where = variable_name(d, h.weakest_variable);
  c.pivot_growth = h.growth;
  c.fronts = static_cast<int>(d.skeleton->joint.plan->fronts.size());
  c.fronts_made = d.factors->fronts_made();
  c.plans_renewed = d.plans_renewed;
  std::vector<double> margins = *d.margins;
  find_margins(d, d.changed_loops, margins);
  worst_margin(d, margins, check);
  self_check(d, check);
  c.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // At distance delta from singular the margin is about 4/delta, and a pivot keeps delta/2.
  const double by_margin = 4 / c.margin, by_pivot = 2 * c.weakest_pivot;
  if (by_margin < kFewDigits)
    check.notes.push_back({Note::Kind::warning, "certify",
                           fmt::format("the loop at {} has margin {:.2g}: {} left", c.margin_where,
                                       c.margin, digits_at(by_margin))});
  else if (by_pivot < kFewDigits)
    check.notes.push_back({Note::Kind::warning, "certify",
                           fmt::format("the pivot at {} keeps {:.1e} of its terms: {} left",
                                       c.weakest_where, c.weakest_pivot, digits_at(by_pivot))});
  if (c.residual > kWarn)
    check.notes.push_back({Note::Kind::warning, "certify",
                           fmt::format("{} holds only to {:.1g}", c.residual_where, c.residual)});
  return check;
}

}  // namespace titop::detail

namespace titop {

std::string to_string(const Certificate& c) {
  std::string text;
  text += fmt::format("equations as written hold to {:.1e} at s = {:.3g}{:+.3g}j{}\n", c.residual,
                      c.s.real(), c.s.imag(),
                      c.residual_where.empty() ? "" : " (worst: " + c.residual_where + ")");
  text += c.dense_against_factors < 0
              ? std::string("dense model not written yet\n")
              : fmt::format(
                    "dense model agrees with the factors to {:.1e}; its rounding changes the "
                    "transfer by {:.1e} at s = {:.3g}{:+.3g}j\n",
                    c.dense_against_factors, c.dense_error, c.dense_error_s.real(),
                    c.dense_error_s.imag());
  text += fmt::format("weakest pivot keeps {:.1e} of its terms{}, growth {:.3g}\n", c.weakest_pivot,
                      c.weakest_where.empty() ? "" : " (" + c.weakest_where + ")", c.pivot_growth);
  text +=
      fmt::format("largest loop margin {:.3g}{}{}\n", c.margin,
                  c.margin_where.empty() ? "" : " (at " + c.margin_where + ")",
                  c.margin_is_exact ? "" : "; loops too large for it are judged by their pivots");
  return text;
}

}  // namespace titop
