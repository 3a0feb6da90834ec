#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/solve/known_solution.hpp>
#include <titop/compiler/solve/margins.hpp>
#include <titop/compiler/solve/null_rows.hpp>
#include <titop/compiler/solve/weak_pivot.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::detail {
namespace {

using linalg::at;
using solve::kLeftOfZero;

/// The errors concern an unknown of this loop.
bool without_digit(const Factored& d, const Loop& loop, const Eigen::ArrayXd& errors) {
  const solve::JointSystem& joint = d.skeleton->joint;
  const solve::Plan& plan = *joint.plan;
  for (const int signal : loop.signals)
    if (const int v = joint.variable_of[at(signal)]; v >= 0)
      if (!(errors.segment(plan.first[at(v)], plan.structure.variable_size[at(v)]) <= kThreeDigits)
               .all())
        return true;
  return false;
}

/// An unknown of a loop too large for a margin may have no digit.
bool large_loop_in_doubt(const Factored& d) {
  const auto is_large = [](const Loop& loop) { return loop.unknowns > kMarginUpTo; };
  const std::vector<Loop>& loops = d.skeleton->stage.loops;
  if (std::ranges::none_of(loops, is_large)) return false;
  const Eigen::ArrayXd errors = errors_of_known_solution(d);
  return std::ranges::any_of(
      loops, [&](const Loop& loop) { return is_large(loop) && without_digit(d, loop, errors); });
}

/// Signals of the loop without a digit, or of the weakest pivot's; empty if there is neither.
std::vector<int> signals_without_digit(const Factored& d) {
  const Skeleton& k = *d.skeleton;
  if (const int loop = judge_margins(k.stage, *d.margins).without_digit; loop >= 0)
    return k.stage.loops[at(loop)].signals;
  const Eigen::ArrayXd errors = errors_left_of_known_solution(d);
  for (const Loop& loop : k.stage.loops)
    if (without_digit(d, loop, errors)) return loop.signals;
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
  const WellPosedness loops = judge_margins(k.stage, margins);
  if (!(weakest < kFewDigits || loops.largest > 10 / kFewDigits || loops.without_digit >= 0 ||
        large_loop_in_doubt(d)))
    return {};
  // Not after reduction: loops of the equations as written may then be singular.
  if (loops.without_digit >= 0 && !k.before_reduce) return {.least = kLeftOfZero};
  if ((errors_left_of_known_solution(d) <= kThreeDigits).all()) return {};
  return {.least = std::clamp(2 * weakest, kLeftOfZero, solve::kCancelled)};
}

Mistake no_digit_left(const Factored& d) {
  std::vector<std::string> ports;
  for (const int s : signals_without_digit(d)) ports.push_back(name_of(d.graph(), s));
  return {Code::ill_posed,
          fmt::format("the algebraic loop through {} has no unique solution, or none with a digit "
                      "in double",
                      ports.empty() ? "a sum of many terms" : some_names(ports)),
          {"no digit remains: in double a pivot there is rounding alone"},
          "break the direct feedthrough there: give one block of the loop a state, or change a "
          "gain"};
}

}  // namespace titop::detail
