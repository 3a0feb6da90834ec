#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/tried_points.hpp>
#include <titop/compiler/certificate/without_rounding.hpp>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/frequency.hpp>
#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/solve/samples.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/name_order.hpp>

/// Entries of a dense model that are rounding alone.
namespace titop::detail {

namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using linalg::kEpsilon;
using solve::RowMatrix;

/// All states and inputs at 1, one after the other.
Instant one_by_one(const Factored& d, const StateSpace& m) {
  const Eigen::Index n = m.A.rows(), all = n + m.B.cols();
  const RowMatrix<double> one = RowMatrix<double>::Identity(all, all), u = one.bottomRows(all - n);
  const RowMatrix<double> x = d.states.expanded(RowMatrix<double>(one.topRows(n)), u);
  RowMatrix<double> known(x.rows() + u.rows(), all);
  known << x, u;
  return Instant(d, std::move(known));
}

/// Rounding of xdot, of all blocks' states, and of y.
StateSpace rounding(const Factored& d, const StateSpace& m, const Instant& now) {
  const auto above = [](const RowMatrix<double>& x, const RowMatrix<double>& y) {
    MatrixXd both(x.rows() + y.rows(), x.cols());
    both << x, y;
    return both;
  };
  const MatrixXd both = largest_of_samples([&](int i) {
                          const Instant off = now.doubt(i);
                          return above(off.xdot(), off.outputs());
                        }).cwiseMax(kEpsilon * above(now.xdot_terms(), now.outputs_terms()));
  const Eigen::Index n = m.A.cols(), inputs = m.B.cols(), outputs = m.C.rows();
  const MatrixXd of_x = d.states.kept_rows(MatrixXd(both.topRows(both.rows() - outputs))),
                 of_y = both.bottomRows(outputs);
  return {of_x.leftCols(n), of_x.rightCols(inputs),
          of_y.leftCols(n), of_y.rightCols(inputs),
          m.states,         m.inputs,
          m.outputs};
}

/// Differences of the model, written in another order, from the factors are rounding.
void add_written(MatrixXd& of, const MatrixXd& now, const MatrixXd& written) {
  of = of.cwiseMax((now - written).cwiseAbs());
}

}  // namespace

StateSpace rounding_of(const Factored& d, const StateSpace& dense) {
  return rounding(d, dense, one_by_one(d, dense));
}

namespace {

StateSpace cleared(const StateSpace& m, const StateSpace& rounding) {
  StateSpace result = m;
  for (MatrixXd StateSpace::*part :
       {&StateSpace::A, &StateSpace::B, &StateSpace::C, &StateSpace::D})
    result.*part = detail::cleared(m.*part, rounding.*part);
  return result;
}

/// From the slowest block by itself to the assembly's fastest, each about once.
std::vector<std::complex<double>> points_of(const Factored& d, const MatrixXd& A) {
  std::vector<double> omegas = frequencies_of(A);
  omegas.push_back(std::abs(pick_s(d)));
  double slowest = omegas.back();
  for (const int i : d.layout().state_nodes)
    if (const double w = frequency_of(d.numbers.blocks[static_cast<std::size_t>(i)]->A); w > 0)
      slowest = std::min(slowest, w);
  omegas.push_back(slowest);
  std::sort(omegas.begin(), omegas.end());
  std::vector<std::complex<double>> points;
  for (const double w : omegas)
    if (points.empty() || w > kNear * std::abs(points.back())) points.push_back(off_axis(w));
  return points;
}

std::optional<MatrixXcd> transfer_of(const StateSpace& m, std::complex<double> s) {
  try {
    return refined_transfers(m, {s}).front();
  } catch (const Error& error) {
    if (!error.has(Code::singular)) throw;
    return {};
  }
}

/// The factors' transfer, and the allowed error of another model: ten times the error of the model
/// as written, plus 1e-8 of the entry, plus the rounding of the factors.
struct Reference {
  MatrixXcd G;
  MatrixXd allowed;
};
std::optional<Reference> reference(const Factored& d, const StateSpace& written,
                                   std::complex<double> s) {
  using T = std::complex<double>;
  const Eigen::Index inputs = written.B.cols();
  try {
    const Evaluation<T> point(d, s, RowMatrix<T>::Identity(inputs, inputs));
    MatrixXcd G = point.outputs();
    const MatrixXd size = G.cwiseAbs();
    const MatrixXd around = size.rowwise().maxCoeff().cwiseSqrt() *
                            Eigen::RowVectorXd(size.colwise().maxCoeff().cwiseSqrt());
    MatrixXd allowed = kAnotherDigit * (refined_transfers(written, {s}).front() - G).cwiseAbs() +
                       kUnchanged * size + linalg::kProductRounding * around +
                       kNoise * point.rounding().cwiseAbs();
    if (!allowed.allFinite()) return {};
    return Reference{std::move(G), std::move(allowed)};
  } catch (const Error& error) {
    if (!error.has(Code::singular) && !error.has(Code::not_finite)) throw;
    return {};  // no digit there: other points must suffice
  }
}

/// An entry of which rounding is up to a third may still be decisive: 1 / (1 - g) of a loop with g
/// near 1. Without it a different system would be judged.
bool keeps_transfer(const Factored& d, const StateSpace& written, const StateSpace& without) {
  if (written.inputs.empty() || written.outputs.empty()) return true;
  if (written.A == without.A && written.B == without.B && written.C == without.C &&
      written.D == without.D)
    return true;
  for (const std::complex<double> s : points_of(d, states_by_name(written).A)) {
    const std::optional<Reference> there = reference(d, written, s);
    if (!there) continue;
    const std::optional<MatrixXcd> G = transfer_of(without, s);
    if (!G || !((*G - there->G).cwiseAbs().array() <= there->allowed.array()).all()) return false;
  }
  return true;
}

}  // namespace

Rounded without_rounding(const Factored& d, StateSpace m) {
  const Instant now = one_by_one(d, m);
  StateSpace r = rounding(d, m, now);
  const RowMatrix<double> xdot = d.states.kept_rows(now.xdot()), y = now.outputs();
  const Eigen::Index n = m.A.cols(), inputs = m.B.cols();
  add_written(r.A, xdot.leftCols(n), m.A);
  add_written(r.B, xdot.rightCols(inputs), m.B);
  add_written(r.C, y.leftCols(n), m.C);
  add_written(r.D, y.rightCols(inputs), m.D);
  if (StateSpace without = cleared(m, r); keeps_transfer(d, m, without)) m = std::move(without);
  return {std::move(m), std::move(r)};
}

}  // namespace titop::detail
