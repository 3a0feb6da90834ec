#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <titop/compiler/certificate/check.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/self_check.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/margins.hpp>
#include <titop/compiler/solve/weak_pivot.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {
namespace {

using linalg::at;

/// "about 2 digits are": the digits of a loop at this distance from singular.
std::string digits_at(double distance) {
  const double digits = std::max(0.0, std::round(std::log10(2 * distance / linalg::kEpsilon)));
  return digits == 1 ? "about one digit is" : fmt::format("about {:.0f} digits are", digits);
}

std::string variable_name(const Factored& d, int variable) {
  const int signal = d.skeleton->joint.variables[at(variable)];
  return signal < 0 ? "a sum of many terms" : name_of(d.graph(), signal);
}

/// The largest margin of a loop, and the loops whose margins are not computed.
void take_margins(const Factored& d, std::span<const double> margins, Check& check) {
  Certificate& c = check.certificate;
  const WellPosedness found = judge_margins(d.skeleton->stage, margins);
  c.margin = found.largest;
  if (found.largest_loop >= 0)
    c.margin_where =
        name_of(d.graph(), d.skeleton->stage.loops[at(found.largest_loop)].signals.front());
  c.margin_is_exact = found.too_large == 0 && found.without_inverse == 0;
  if (const int n = found.too_large; n > 0)
    check.notes.push_back(
        {Note::Kind::info, "certify",
         fmt::format("{} loop{} of more than {} unknowns: checked by a known solution, not by {} "
                     "margin",
                     n, n == 1 ? "" : "s", kMarginUpTo, n == 1 ? "its" : "their")});
}

}  // namespace

Check certify(const Factored& d) {
  const auto start = std::chrono::steady_clock::now();
  const solve::Health h = d.factors->health();
  Check check;
  Certificate& c = check.certificate;
  c.weakest_pivot = h.weakest;
  if (h.weakest_variable >= 0) c.weakest_where = variable_name(d, h.weakest_variable);
  c.pivot_growth = h.growth;
  c.fronts = static_cast<int>(d.skeleton->joint.plan->fronts.size());
  c.fronts_made = d.factors->fronts_made();
  c.plans_renewed = d.plans_renewed;
  for (const ByDifferences& b : d.skeleton->stage.by_differences)
    c.by_differences.push_back(
        fmt::format("{} of {}", d.graph().parameters[at(b.parameter)].name, b.block));
  std::vector<double> margins = *d.margins;
  find_margins(d, d.changed_loops, margins);
  take_margins(d, margins, check);
  self_check(d, check);
  const WeakPivots weak = d.weak_pivots ? *d.weak_pivots : judge_weak_pivots(d, margins);
  c.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // At distance delta from singular the margin is about 4/delta, and a pivot keeps delta/2.
  const double by_margin = 4 / c.margin, by_pivot = 2 * c.weakest_pivot;
  const char* const data = "look for mixed units, tiny masses and long levers";
  if (by_margin < kFewDigits)
    check.warn(fmt::format("the loop at {} has margin {:.2g}: {} left; {}", c.margin_where,
                           c.margin, digits_at(by_margin), data));
  else if (by_pivot < kFewDigits)
    check.warn(fmt::format("the pivot at {} is {:.1e} of its terms: {} left; {}", c.weakest_where,
                           c.weakest_pivot, digits_at(by_pivot), data));
  if (c.residual > kWarn)
    check.warn(
        fmt::format("{} is satisfied only to {:.1g}: compare outputs with those of "
                    "transfer(s, Precision::digits50)",
                    c.residual_where, c.residual));
  if (weak.least > 0)
    check.warn(
        "no digit remains: in double a pivot is rounding alone; check the data (transfer uses "
        "finer arithmetic)");
  return check;
}

}  // namespace titop::detail

namespace titop {

namespace {

std::string words_of_residual(const Certificate& c) {
  if (c.residual < 0) return "equations as written not checked: there are no inputs\n";
  return fmt::format("equations as written are satisfied to {:.1e} {} s = {:.3g}{}\n", c.residual,
                     c.at_instant ? "at an instant, responses of single blocks at" : "at", c.s,
                     c.residual_where.empty() ? "" : " (worst: " + c.residual_where + ")");
}

std::string words_of_apply(const Certificate& c) {
  if (c.apply_against_transfer < 0) return {};
  return fmt::format("apply agrees with the transfer to {:.1e} at s = {:.3g}\n",
                     std::max(c.apply_against_transfer, detail::kWarn), c.s);
}

std::string words_of_dense(const Certificate& c) {
  if (c.dense_against_factors < 0) return {};
  std::string text =
      fmt::format("dense model agrees with the factors to {:.1e}", c.dense_against_factors);
  if (c.dense_error >= 0)
    text += fmt::format(
        "; its rounding changes the outputs by {:.1e} of their largest value at s = "
        "{:.3g}{:+.3g}j, by {:.1e} of their value at s = {:.3g}{:+.3g}j",
        c.dense_error, c.dense_error_s.real(), c.dense_error_s.imag(), c.dense_error_where_small,
        c.dense_error_where_small_s.real(), c.dense_error_where_small_s.imag());
  return text + "\n";
}

}  // namespace

std::string to_string(const Certificate& c) {
  std::string text = words_of_residual(c) + words_of_apply(c) + words_of_dense(c);
  text += fmt::format("weakest pivot {:.1e} of its terms{}, growth {:.3g}\n", c.weakest_pivot,
                      c.weakest_where.empty() ? "" : " (" + c.weakest_where + ")", c.pivot_growth);
  text += fmt::format("largest loop margin {:.3g}{}{}\n", c.margin,
                      c.margin_where.empty() ? "" : " (at " + c.margin_where + ")",
                      c.margin_is_exact ? "" : "; larger loops are checked by a known solution");
  for (const std::string& name : c.by_differences)
    text += fmt::format("derivative by {}: by differences of the block's matrices\n", name);
  return text;
}

}  // namespace titop
