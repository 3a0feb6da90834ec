#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <titop/compiler/certificate/apply_check.hpp>
#include <titop/compiler/certificate/around_states.hpp>
#include <titop/compiler/certificate/check.hpp>
#include <titop/compiler/certificate/doubt.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/self_check.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/frequency.hpp>
#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/graph/ahead.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <titop/graph/support/steady_random.hpp>
#include <utility>

namespace titop::detail {
namespace {

using linalg::at;

using solve::RowMatrix;

constexpr double kRealShare = 0.6180;  ///< of |pick_s|: the s of the certificate

RowMatrix<double> random_input(const Factored& d) {
  SteadyRandom random;
  RowMatrix<double> u(static_cast<Eigen::Index>(d.layout().inputs.size()), 1);
  for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = random.next();
  return u;
}

/// Every signal follows from states and inputs, and no state from others.
bool has_instants(const Factored& d) {
  if (d.skeleton->before_reduce || !d.states.trivial() || d.states.by_input().size() > 0 ||
      has_closed_form(d.graph()))
    return false;
  for (const Equation& e : d.skeleton->stage.source->equations)
    for (const Term& t : e.terms)
      if (t.of == Term::Of::position || t.of == Term::Of::rate) return false;
  return true;
}

/// The inputs of node i, all of them.
void take_inputs(const Factored& d, int i, const Instant& now, RowMatrix<double>& inputs) {
  const Node& node = d.graph().nodes[at(i)];
  inputs.setZero(d.numbers.blocks[at(i)]->B.cols(), 1);
  for (int k = node.first_signal; k < node.state; ++k)
    if (const Signal& in = d.graph().signals[at(k)]; in.role == Signal::Role::input && in.active)
      now.add_value(k, inputs.data() + in.first);
}

/// x = (s - A)^-1 x of every block by itself, x the states of all blocks. Blocks that are the same
/// object share one factorisation; only one is kept at a time.
void resolve(const Factored& d, double s, double* x) {
  std::vector<std::pair<const Dynamics*, int>> blocks;
  blocks.reserve(d.layout().state_nodes.size());
  for (const int i : d.layout().state_nodes)
    blocks.emplace_back(d.numbers.blocks[at(i)].get(), d.layout().state_first[at(i)]);
  std::sort(blocks.begin(), blocks.end());
  for (std::size_t k = 0; k < blocks.size();) {
    const Dynamics* const block = blocks[k].first;
    const Resolvent<double> resolvent(*block, s);
    for (; k < blocks.size() && blocks[k].first == block; ++k)
      resolvent.apply(1, x + blocks[k].second);
  }
}

/// Largest |value| beyond `rounding` over `magnitude`, row by row; 1 if it is not finite.
double relative(const Eigen::VectorXd& value, const Eigen::VectorXd& magnitude,
                const Eigen::VectorXd& rounding) {
  double worst = 0;
  for (Eigen::Index i = 0; i < value.size(); ++i)
    if (const double off = std::abs(value(i)) - rounding(i); !(off <= kUnderflow))
      worst = std::max(worst, std::isfinite(off) ? off / magnitude(i) : 1.0);
  return worst;
}

/// The response of one block for inputs u by its own formula and by its matrices.
struct TwoResponses {
  const Dynamics& m;
  double s;
  const Eigen::VectorXd& u;
  solve::BlockResponse<double> formula;
  Eigen::VectorXd x;

  /// Largest difference of states and outputs relative to the terms of each.
  double difference(const Eigen::VectorXd& rounding_of_x) const {
    const Eigen::VectorXd size = u.cwiseAbs();
    const double states =
        relative(formula.X * u - x, formula.X.cwiseAbs() * size + x.cwiseAbs(), rounding_of_x);
    if (!m.sparse.empty()) return states;
    return std::max(states, relative(formula.Y * u - (m.C * x + m.D * u),
                                     formula.Y.cwiseAbs() * size + m.C.cwiseAbs() * x.cwiseAbs() +
                                         m.D.cwiseAbs() * size,
                                     m.C.cwiseAbs() * rounding_of_x));
  }
  /// Of x, with K = s - A: an LU solution is off by at most 3 n u |K^-1| (|L| |U| |x| + |B| |v|), u
  /// half of epsilon [Higham 2002, theorem 9.4]. Of two solutions, with |L| |U| up to 5 |K|: 16 n
  /// epsilon. All states count by the largest in the states' own sizes: one that no input reaches
  /// is rounding of the others.
  Eigen::VectorXd rounding() const {
    constexpr double kUnits = 16;
    const auto n = m.A.rows();
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
    const Eigen::MatrixXd inverse = Resolvent<double>(m, s).times(one);
    Eigen::MatrixXd scaled = m.A;
    const Eigen::VectorXd unit = linalg::similarity_scaling_of_parts(scaled);
    const double largest = x.cwiseQuotient(unit).cwiseAbs().maxCoeff();
    const Eigen::VectorXd terms =
        (s * one - m.A).cwiseAbs() * (largest * unit) + m.B.cwiseAbs() * u.cwiseAbs();
    return kUnits * static_cast<double>(n) * linalg::kEpsilon * (inverse.cwiseAbs() * terms);
  }
};

/// The blocks' own formulas at s, used by transfers, against their A, B, C, D, for random inputs:
/// of the first blocks of each type, since a type has one formula. An instant does not use them.
WrittenResidual check_responses(const Factored& d, double s) {
  constexpr std::size_t kOfEachType = 2;
  WrittenResidual result;
  SteadyRandom random;
  std::map<std::string_view, std::set<const Dynamics*>> seen;
  for (const int i : d.layout().state_nodes) {
    const Node& node = d.graph().nodes[at(i)];
    fetch_ahead(d.graph(), at(i));
    const Dynamics& m = *d.numbers.blocks[at(i)];
    auto& of_type = seen[node.block->type()];
    if (of_type.size() == kOfEachType || !of_type.insert(&m).second) continue;
    Eigen::VectorXd u(m.B.cols());
    for (double& v : u) v = random.next();
    const TwoResponses both{m, s, u, response<double>(*node.block, m, s, d.numbers.parameters),
                            Resolvent<double>(m, s).times(m.B * u)};
    double worst = both.difference(Eigen::VectorXd::Zero(m.A.rows()));
    // With modes, each state is a quotient, and a 0 is exact.
    if (worst > kWarn && !m.modal) worst = both.difference(both.rounding());
    if (worst > result.worst) result = {worst, "the response of " + node.name};
  }
  return result;
}

/// [x; u] with the states of each block by itself at s for the inputs that it gets when u alone
/// acts. Strictly proper blocks have no direct term: blocks at rest behind one get random inputs of
/// size 1, not the outputs of the others, since stiff blocks have outputs much larger than their
/// inputs, and the effect of u must not be hidden. One solution.
RowMatrix<double> known_at_instant(const Factored& d, const RowMatrix<double>& u, double s) {
  const Layout& l = d.layout();
  RowMatrix<double> known = RowMatrix<double>::Zero(l.order() + u.rows(), 1), inputs;
  known.bottomRows(u.rows()) = u;
  const Instant by_u(d, known);
  SteadyRandom random;
  for (int i = 0; i < static_cast<int>(l.state_first.size()); ++i) {
    if (l.state_first[at(i)] < 0) continue;
    const Dynamics& m = *d.numbers.blocks[at(i)];
    take_inputs(d, i, by_u, inputs);
    if (inputs.isZero(0))
      for (double& x : inputs.reshaped()) x = random.next();
    solve::add_dense_product(m.B.rows(), m.B.cols(), m.B.data(), inputs.data(), 1,
                             known.data() + l.state_first[at(i)]);
  }
  resolve(d, s, known.data());
  return known;
}

/// A residual above rounding is computed again with a sample of the signals' rounding.
template <class Rounding>
WrittenResidual residual_of(const Factored& d, Signals& signals, Rounding rounding) {
  const WrittenResidual written = written_residual(d, signals);
  if (written.worst <= kWarn) return written;
  signals.rounding = rounding();
  return written_residual(d, signals);
}

/// At one instant. False if it is impossible, or if the equations are satisfied but digits may be
/// lost.
bool check_instant(const Factored& d, const RowMatrix<double>& u, double s, Certificate& c) {
  if (!has_instants(d) || d.layout().order() + u.size() == 0) return false;
  const Instant now(d, known_at_instant(d, u, s));
  if (!now.unknowns().allFinite()) return false;
  Signals signals{first_of_signals(d.graph())};
  signals.values = now.values(signals.first);
  signals.unknowns = now.unknowns();
  WrittenResidual written =
      residual_of(d, signals, [&] { return now.rounding().values(signals.first); });
  // Two formulas for one thing differ by more than rounding near a block's own real pole.
  if (const auto responses = check_responses(d, s);
      responses.worst > std::max(kWarn, written.worst))
    written = responses;
  if (written.worst <= kWarn && digits_in_doubt(d, now, signals)) return false;
  c.residual = written.worst;
  c.residual_where = written.where;
  c.at_instant = true;
  return true;
}

/// Loss of the outputs in double, the sum of the losses by each input alone, but for blocks
/// that are 0 by symmetry: beside the effect of another input, in any unit, their rounding may be
/// large. A solution of two columns per input.
RowMatrix<double> lost_by_inputs(const Factored& d, const RowMatrix<double>& u, double s) {
  Evaluation<double> each(d, s, unit_inputs<double>(d));
  const RowMatrix<double> before = each.outputs();
  each.losses();
  RowMatrix<double> off = (each.outputs() - before).cwiseAbs().cwiseMax(each.rounding().cwiseAbs());
  const std::vector<Eigen::Index> rows = groups_of_outputs(d, all_outputs(d)).first,
                                  cols = groups_of_inputs(d, all_inputs(d)).first;
  const Eigen::MatrixX<bool>& zero = d.zero_blocks();
  for (Eigen::Index i = 0; i < zero.rows(); ++i)
    for (Eigen::Index j = 0; j < zero.cols(); ++j)
      if (zero(i, j))
        off.block(rows[at(i)], cols[at(j)], rows[at(i + 1)] - rows[at(i)],
                  cols[at(j + 1)] - cols[at(j)])
            .setZero();
  return off * u.cwiseAbs();
}

/// Share of the outputs that double loses at a real s. An output that is 0 by cancellation, without
/// a size to compare with, counts as having lost none: it is rounding only.
void find_lost(const Factored& d, Evaluation<double>& point, const RowMatrix<double>& u, double s,
               Check& check) {
  const RowMatrix<double> before = point.outputs();
  const auto losses = point.losses();
  check.lost = std::max(losses.change, losses.rounding);
  if (check.lost <= kWarn) return;
  const RowMatrix<double> y = point.outputs();
  AroundStates around(d, point, s);
  const auto lost = [&](const RowMatrix<double>& off) {
    return lost_of_outputs(d, point.unknowns(), y, around.without_zeros(y, off));
  };
  double told = std::max(lost(y - before), lost(point.rounding()));
  if (told > kWarn && d.zero_blocks().any()) told = std::min(told, lost(lost_by_inputs(d, u, s)));
  check.rounding_alone = told < check.lost;
  check.lost = std::min(check.lost, told);
}

std::string words_of(const ApplyDifference& found, double s) {
  const std::string why =
      found.prevented.empty()
          ? "please report this diagram"
          : fmt::format(
                "closed chains prevent the motion {}, which an equation prescribes: remove "
                "that equation, or open the chain",
                found.prevented);
  return fmt::format(
      "apply and the transfer differ by {:.1g} at s = {:.3g}, so do A, B, C, D and simulate: {}",
      found.worst, s, why);
}

/// At one real s: equations satisfied at every real s are satisfied at every s. Half the
/// arithmetic.
void check_at_s(const Factored& d, const RowMatrix<double>& u, double s, Check& check) {
  Evaluation<double> point(d, s, u);
  Signals signals{first_of_signals(d.graph())};
  signals.values = point.values(signals.first);
  signals.unknowns = point.unknowns();
  signals.s = s;
  const WrittenResidual written =
      residual_of(d, signals, [&] { return point.rounding_of_values(signals.first); });
  check.certificate.residual = written.worst;
  check.certificate.residual_where = written.where;
  find_lost(d, point, u, s, check);
  if (!has_closed_form(d.graph())) {
    const ApplyDifference found = apply_difference(d, point, u, s, check.lost);
    check.certificate.apply_against_transfer = found.worst;
    if (found.worst > kWarn) check.warn(words_of(found, s));
  }
  if (const double lost = check.lost; lost > kWarn)
    check.warn(
        fmt::format("in double the outputs are accurate to {:.1g} at s = {:.3g}: transfer uses "
                    "finer arithmetic, apply and A, B, C, D have only these digits",
                    lost, s));
}

}  // namespace

void self_check(const Factored& d, Check& check) try {
  Certificate& certificate = check.certificate;
  const RowMatrix<double> u = random_input(d);
  // Not |pick_s| itself, where a block by itself may have a pole.
  const double s = kRealShare * std::abs(pick_s(d));
  certificate.s = s;
  if (check_instant(d, u, s, certificate)) return;
  if (u.size() > 0)
    check_at_s(d, u, s, check);
  else
    certificate.residual = -1;  // at s nothing moves
} catch (const Error& error) {
  if (!error.has(Code::singular)) throw;
  check.certificate.residual = 1;
  check.certificate.residual_where = "no equation: in double the system is singular";
}

}  // namespace titop::detail
