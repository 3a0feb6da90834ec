#include <fmt/format.h>

#include <limits>
#include <titop/compiler/solve/holds.hpp>
#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/solve/lifted_rows.hpp>
#include <titop/graph/linalg/index.hpp>

/// xdot and y of given states and inputs: in double, or with unknowns refined in double-double.
namespace titop::detail {
namespace {

using solve::in_double;
using solve::RowMatrix;
using Twofold = std::complex<solve::DoubleDouble>;

/// Pivots smaller than this of their terms lose three digits: entries of A, B, C, D, each by
/// itself, are then off by 1e-13 or more, and a response in which they cancel as the pivot did, by
/// as many digits again. Above it this is below 1e-9 of any response.
constexpr double kLossy = 0x1p-10;

/// Steps until the unknowns have 1e-16, at three digits of the factors each.
constexpr int kMostSteps = 8;

Error not_solved(const Factored& d) {
  const solve::Health h = d.factors->health();
  const int signal =
      h.weakest_variable < 0 ? -1 : d.skeleton->joint.variables[linalg::at(h.weakest_variable)];
  return {Code::singular,
          fmt::format("{}: for given states and inputs refinement does not solve the equations to "
                      "the rounding of double{}",
                      d.graph().name,
                      signal < 0 ? ""
                                 : fmt::format("; the weakest pivot, {:.1g} of its terms, is that "
                                               "of {}",
                                               h.weakest, name_of(d.graph(), signal))),
          "change the gains, masses or springs there, or ask for a transfer with "
          "Precision::digits50"};
}

/// Refines the unknowns with the factors in double. Throws singular if they do not solve the
/// equations then.
void refine(InstantIn<Twofold>& now, const RowMatrix<double>& more) {
  RowMatrix<Twofold> rhs = now.rhs();
  if (more.size() > 0) rhs += solve::lifted<Twofold>(more);
  now.unknowns = RowMatrix<Twofold>::Zero(rhs.rows(), rhs.cols());
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; rhs.size() > 0 && step < kMostSteps; ++step) {
    const RowMatrix<double> change =
        now.data.factors->solve(in_double(now.rows.residual(rhs, now.unknowns)).real());
    now.unknowns += solve::lifted<Twofold>(change);
    const double size = change.cwiseAbs().maxCoeff();
    if (!(2 * size <= before)) break;  // no digit remains, or no error
    before = size;
  }
  if (in_double(now.unknowns).allFinite() && !holds(now, rhs, solve::Scalar<double>::epsilon()))
    throw not_solved(now.data);
}

RateColumns finer_rates(const Factored& d, const RowMatrix<double>& known,
                        const RowMatrix<double>& more) {
  const LiftedRows<Twofold> lifted(d);
  InstantIn<Twofold> now{d, lifted.rows(), solve::lifted<Twofold>(known)};
  refine(now, more);
  const auto add_to = [](RowMatrix<Twofold>& to) {
    return [&to](Eigen::Index first, const auto& m, const Twofold* x) {
      const Eigen::Map<const RowMatrix<Twofold>> value(x, m.cols(), to.cols());
      to.middleRows(first, m.rows()) += solve::lifted<Twofold>(m).lazyProduct(value);
    };
  };
  RowMatrix<Twofold> xdot = RowMatrix<Twofold>::Zero(d.layout().order(), known.cols());
  RowMatrix<Twofold> y = RowMatrix<Twofold>::Zero(std::ssize(d.layout().outputs), known.cols());
  now.products_of_xdot(add_to(xdot));
  now.products_of_outputs(add_to(y));
  return {in_double(xdot).real(), in_double(y).real()};
}

}  // namespace

RateColumns rates(const Factored& d, const RowMatrix<double>& known,
                  const RowMatrix<double>& more) {
  if (d.factors->health().weakest < kLossy) return finer_rates(d, known, more);
  const Instant now(d, known, more, solve::Refinement::settled);
  if (!now.holds() && now.unknowns().allFinite()) return finer_rates(d, known, more);
  return {now.xdot(), now.outputs()};
}

}  // namespace titop::detail
