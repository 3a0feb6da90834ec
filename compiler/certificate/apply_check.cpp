#include <cmath>
#include <titop/compiler/certificate/apply_check.hpp>
#include <titop/compiler/certificate/around_states.hpp>
#include <titop/compiler/certificate/doubt.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/solve/samples.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {

using linalg::at;
using solve::RowMatrix;

namespace {

/// Name of a dependent state whose rate differs from the one by the independent states' rates by
/// more than half of its terms; empty if there is none.
std::string prevented(const Factored& d, const RowMatrix<double>& xdot,
                      const RowMatrix<double>& terms) {
  constexpr double kMost = 0.5;
  if (d.states.by_input().size() > 0) return {};
  const RowMatrix<double> off = xdot - d.states.expanded(d.states.kept_rows(xdot));
  for (const StateMap::DependentRow& row : d.states.dependent())
    if (std::abs(off(row.state)) > kMost * terms(row.state))
      return d.layout().states[at(row.state)];
  return {};
}

/// Each the largest of its unit: in turned frames entries of one motion or force mix.
void share_by_unit(const Factored& d, RowMatrix<double>& rounding) {
  for (std::size_t o = 0; o < d.graph().outputs.size(); ++o) {
    const int size = d.graph().outputs[o].size, each = size == 6 ? 3 : 1;
    for (int k = 0; k < size; k += each) {
      auto unit = rounding.middleRows(d.layout().output_first[o] + k, each);
      unit.setConstant(unit.maxCoeff());
    }
  }
}

}  // namespace

/// With x of the transfer at s, the model xdot = A x + B u, y = C x + D u that apply computes has
/// the outputs y + C (s - A)^-1 (xdot - s x), whatever the rounding of x is.
ApplyDifference apply_difference(const Factored& d, const Evaluation<double>& point,
                                 const RowMatrix<double>& u, double s, double lost) {
  const RowMatrix<double> x = d.states.model_states(point.states(), u, s);
  const RowMatrix<double> all = d.states.expanded(x, u), y = point.outputs();
  RowMatrix<double> known(all.rows() + u.rows(), 1);
  known << all, u;
  const auto outputs = [&](const RowMatrix<double>& xdot, const RowMatrix<double>& direct) {
    return RowMatrix<double>(direct + point.forced(d.states.expanded(xdot)));
  };
  const RateColumns now = rates(d, known);
  RowMatrix<double> off = outputs(d.states.kept_rows(now.xdot) - s * x, now.y - y);
  AroundStates around(d, point, s);
  const auto share = [&] {
    return lost_of_outputs(d, point.unknowns(), y, around.without_zeros(y, off));
  };
  if (const double plain = share(); plain <= kWarn) return {plain, {}};
  const Instant plain(d, known);
  const Instant doubt = plain.doubt();
  RowMatrix<double> rounding =
      outputs(d.states.kept_rows(doubt.xdot()), doubt.outputs()).cwiseAbs() +
      point.rounding().cwiseAbs();
  share_by_unit(d, rounding);
  off = (off.cwiseAbs() - linalg::kNoise * rounding).cwiseMax(0);
  const double worst = share();
  if (worst <= kRoundingFactor * lost) return {};
  return {worst, prevented(d, now.xdot, plain.xdot_terms())};
}

}  // namespace titop::detail
