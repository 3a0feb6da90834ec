#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/solve/margins.hpp>
#include <titop/compiler/solve/null_rows.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/compiler/solve/weak_pivot.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::detail {
namespace {

using linalg::at;
using solve::Complex50;
using solve::kLeftOfZero;

constexpr double kMostProducts = 1e7;

double products(const solve::Plan& plan) {
  double sum = 0;
  for (const solve::Front& f : plan.fronts)
    sum += static_cast<double>(f.row_count) * f.pivot_count * f.columns();
  return sum;
}

/// Cancelled entries are exact zeros, so that no rounding is taken for a pivot further up.
bool singular_in_50_digits(const Factored& d) {
  const Skeleton& k = *d.skeleton;
  std::vector<solve::Dense<Complex50>> direct;
  solve::Matrices<Complex50> m;
  direct.reserve(d.numbers.blocks.size());
  for (const auto& block : d.numbers.blocks) {
    direct.push_back(solve::lifted<Complex50>(block->D));
    m.direct.push_back(&direct.back());
  }
  const solve::JointRows<Complex50> rows(k.stage.graph, k.joint, d.numbers.coefficients,
                                         std::move(m));
  const solve::Factors<Complex50> factors(k.joint.plan, rows, d.factors->scale(),
                                          solve::NoPivot::patch);
  const double rounding = solve::kNothingLeft * solve::Scalar<double>::epsilon();
  const solve::Health h = factors.health();
  return h.finite && (!factors.patches().empty() || h.weakest < rounding);
}

/// Signals of the loop without a digit, or of the weakest pivot's; empty if there is neither.
std::vector<int> signals_without_digit(const Factored& d) {
  const Skeleton& k = *d.skeleton;
  if (const int loop = judge_margins(k.stage, *d.margins).without_digit; loop >= 0)
    return k.stage.loops[at(loop)].signals;
  const int variable = d.factors->health().weakest_variable;
  const int signal = variable < 0 ? -1 : k.joint.variables[at(variable)];
  if (signal < 0) return {};
  for (const Loop& loop : k.stage.loops)
    if (std::find(loop.signals.begin(), loop.signals.end(), signal) != loop.signals.end())
      return loop.signals;
  return {signal};
}

}  // namespace

WeakPivots judge_weak_pivots(const Factored& d, std::span<const double> margins) {
  const Skeleton& k = *d.skeleton;
  const double weakest = d.factors->health().weakest;
  const LoopMargins loops = judge_margins(k.stage, margins);
  if (!(weakest < kFewDigits || loops.largest > 10 / kFewDigits || loops.without_digit >= 0))
    return {};
  // Not after reduction: loops of the equations as written may then be singular.
  if (loops.without_digit >= 0 && !k.before_reduce) return {.least = kLeftOfZero};
  if (products(*k.joint.plan) > kMostProducts) return {.undecided = true};
  if (!singular_in_50_digits(d)) return {};
  return {.least = std::clamp(2 * weakest, kLeftOfZero, solve::kCancelled)};
}

Mistake no_digit_left(const Factored& d) {
  std::vector<std::string> ports;
  for (const int s : signals_without_digit(d)) ports.push_back(name_of(d.graph(), s));
  return {Code::ill_posed,
          fmt::format("the algebraic loop through {} has no unique solution, or none with a digit "
                      "in double",
                      ports.empty() ? "a sum of many terms" : some_names(ports)),
          {"no digit is left: in double a pivot there is rounding alone"},
          "break the direct feedthrough there: give one block of the loop a state, or change a "
          "gain"};
}

}  // namespace titop::detail
