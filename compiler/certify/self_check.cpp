#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/certify/residual.hpp>
#include <titop/compiler/certify/self_check.hpp>
#include <titop/compiler/certify/steady_random.hpp>
#include <titop/compiler/evaluate.hpp>
#include <titop/compiler/instant.hpp>

namespace titop::detail {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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

using solve::RowMatrix;

constexpr double kRealShare = 0.6180;  ///< of |pick_s|: the s of the certificate

RowMatrix<double> random_input(const SystemData& d) {
  SteadyRandom random;
  RowMatrix<double> u(static_cast<Eigen::Index>(d.layout().inputs.size()), 1);
  for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = random.next();
  return u;
}

/// Every signal follows from states and inputs, and no state from others.
bool has_instants(const SystemData& d) {
  if (d.skeleton->before_reduce || !d.states.trivial() || d.states.by_input().size() > 0)
    return false;
  for (const Equation& e : d.skeleton->stage.source->equations)
    for (const Term& t : e.terms)
      if (t.of == Term::Of::position || t.of == Term::Of::rate) return false;
  return true;
}

/// The inputs of node i, all of them.
void take_inputs(const SystemData& d, int i, const Instant& now, RowMatrix<double>& inputs) {
  const Node& node = d.graph().nodes[at(i)];
  inputs.setZero(d.numbers.blocks[at(i)]->B.cols(), 1);
  for (int k = node.first_signal; k < node.state; ++k)
    if (const Signal& in = d.graph().signals[at(k)]; in.role == Signal::Role::input && in.active)
      now.add_value(k, inputs.data() + in.first);
}

/// [x; u] with states that each block, moved by itself at s, would make of the inputs that it has
/// when u alone acts. What is strictly proper passes nothing on at once: blocks that rest behind it
/// are moved at random, and then all once more by what that gives.
RowMatrix<double> known_at_instant(const SystemData& d, const RowMatrix<double>& u, double s) {
  const Layout& l = d.layout();
  RowMatrix<double> known = RowMatrix<double>::Zero(l.order() + u.rows(), 1), inputs;
  known.bottomRows(u.rows()) = u;
  SteadyRandom random;
  std::vector<Resolvent<double>> resolvents;  // of the nodes with states
  resolvents.reserve(l.state_nodes.size());
  for (const int i : l.state_nodes) resolvents.emplace_back(*d.numbers.blocks[at(i)], s);
  for (int round = 0; round < 2; ++round) {
    const Instant now(d, known);
    bool all_move = true;
    for (std::size_t k = 0; k < resolvents.size(); ++k) {
      const int i = l.state_nodes[k];
      const Dynamics& m = *d.numbers.blocks[at(i)];
      take_inputs(d, i, now, inputs);
      if (inputs.isZero(0)) {
        for (double& x : inputs.reshaped()) x = random.next();
        all_move = false;
      }
      known.middleRows(l.state_first[at(i)], m.A.rows()) =
          resolvents[k].times(m.B.lazyProduct(inputs));
    }
    if (all_move) break;
  }
  return known;
}

/// These rows of `change` beside the same of `value`.
bool is_small(const RowMatrix<double>& change, const RowMatrix<double>& value, Eigen::Index first,
              Eigen::Index rows) {
  const double off = change.middleRows(first, rows).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  return off <= kWarn * value.middleRows(first, rows).cwiseAbs().maxCoeff() || off <= kUnderflow;
}

/// Rounding may cost digits of this unknown, more than it leaves of a 0.
bool in_doubt(const SystemData& d, const Instant& now, const RowMatrix<double>& change, int v) {
  const solve::Plan& plan = *d.skeleton->joint.plan;
  const Eigen::Index size = plan.structure.variable_size[at(v)],
                     unit = plan.structure.variable_unit[at(v)];
  for (Eigen::Index first = plan.first[at(v)], k = 0; k < size; k += unit)
    if (!is_small(change, now.unknowns(), first + k, unit) &&
        !(change.middleRows(first + k, unit).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <=
          kLeftOfZero * size_around(d, now.unknowns(), v, k)))
      return true;
  return false;
}

/// A row of an output is 0 but for what rounding leaves of its terms.
bool is_zero(const SystemData& d, const Instant& now, std::size_t output, Eigen::Index row,
             double value) {
  const Output& o = d.graph().outputs[output];
  const int first = d.skeleton->joint.output_coefficient[output];
  double around = 0;
  for (std::size_t k = 0; k < o.terms.size(); ++k) {
    const RowMatrix<double>& c = *d.numbers.coefficients[at(first) + k];
    for (Eigen::Index j = 0; j < c.cols(); ++j)
      if (c(row, j) != 0)
        around += std::abs(c(row, j)) * size_around_signal(d, now.unknowns(), o.terms[k].signal, j);
  }
  return std::abs(value) <= kLeftOfZero * around;
}

bool outputs_in_doubt(const SystemData& d, const Instant& now, const RowMatrix<double>& change) {
  const RowMatrix<double> none = RowMatrix<double>::Zero(
      static_cast<Eigen::Index>(d.layout().states.size() + d.layout().inputs.size()), 1);
  const RowMatrix<double> y = now.outputs(), off = now.outputs_of(change, none);
  for (std::size_t o = 0; o < d.graph().outputs.size(); ++o) {
    const Eigen::Index first = d.layout().output_first[o], size = d.graph().outputs[o].size,
                       unit = size == 6 ? 3 : size;
    for (Eigen::Index i = 0; i < size; ++i)
      if (!is_small(off, y, first + i / unit * unit, unit) &&
          !is_zero(d, now, o, i, y(first + i, 0)))
        return true;
  }
  return false;
}

bool digits_in_doubt(const SystemData& d, const Instant& now) {
  const RowMatrix<double> change = now.doubt();
  const auto variables = static_cast<int>(d.skeleton->joint.variables.size());
  for (int v = 0; v < variables; ++v)
    if (in_doubt(d, now, change, v)) return true;
  return outputs_in_doubt(d, now, change);
}

/// At one instant. False where there is none, or where the equations hold and yet digits may be
/// lost.
bool check_instant(const SystemData& d, const RowMatrix<double>& u, double s, Certificate& c) {
  if (!has_instants(d)) return false;
  const Instant now(d, known_at_instant(d, u, s));
  if (!now.unknowns().allFinite()) return false;
  Signals signals{first_of_signals(d.graph())};
  signals.values = now.values(signals.first);
  signals.unknowns = now.unknowns();
  const WrittenResidual written = written_residual(d, signals);
  if (written.worst <= kWarn && digits_in_doubt(d, now)) return false;
  c.residual = written.worst;
  c.residual_where = written.where;
  c.at_instant = true;
  return true;
}

/// At one real s: what holds for every real s holds for every s, at half the arithmetic.
void check_at_s(const SystemData& d, const RowMatrix<double>& u, double s, Check& check) {
  Evaluation<double> point(d, s, u);
  Signals signals{first_of_signals(d.graph())};
  signals.values = point.values(signals.first);
  signals.unknowns = point.unknowns();
  signals.xdot = s * point.states();
  signals.s = s;
  const WrittenResidual written = written_residual(d, signals);
  check.certificate.residual = written.worst;
  check.certificate.residual_where = written.where;
  const auto losses = point.losses();
  if (const double lost = std::max(losses.change, losses.rounding); lost > kWarn)
    check.notes.push_back(
        {Note::Kind::warning, "certify",
         fmt::format(
             "in double the outputs are right to {:.1g} at s = {:.3g}: transfer takes finer "
             "arithmetic, apply and A, B, C, D have these digits only",
             lost, s)});
}

}  // namespace

void self_check(const SystemData& d, Check& check) try {
  Certificate& certificate = check.certificate;
  const RowMatrix<double> u = random_input(d);
  // Not |pick_s| itself, where a block by itself may have a pole.
  const double s = kRealShare * std::abs(pick_s(d));
  certificate.s = s;
  if (u.size() == 0) return;  // nothing moves
  if (!check_instant(d, u, s, certificate)) check_at_s(d, u, s, check);
} catch (const Error& error) {
  if (!error.has(Code::singular)) throw;
  check.certificate.residual = 1;
  check.certificate.residual_where = "in double, not one equation";
}

}  // namespace titop::detail
