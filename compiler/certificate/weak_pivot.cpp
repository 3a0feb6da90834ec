#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <titop/compiler/certificate/check.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/surroundings.hpp>
#include <titop/compiler/certificate/weak_pivot.hpp>
#include <titop/compiler/solve/null_rows.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::detail {
namespace {

using linalg::at;
using solve::Complex50;

constexpr double kMostProducts = 1e7;

bool is_doubtful(const Check& check) {
  const Certificate& c = check.certificate;
  return c.weakest_pivot < kFewDigits || c.margin > 10 / kFewDigits ||
         check.loop_without_digit >= 0 || c.residual > kWarn || check.lost > 1e-3;
}

double products(const solve::Plan& plan) {
  double sum = 0;
  for (const solve::Front& f : plan.fronts)
    sum += static_cast<double>(f.row_count) * f.pivot_count * f.columns();
  return sum;
}

/// Cancelled entries are exact zeros, so that no rounding is taken for a pivot further up.
bool singular_in_50_digits(const Skeleton& k, const Factored& d) {
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

/// The loop without a digit, by its margin.
const Loop* loop_without_digit(const Skeleton& k, const Factored& d) {
  std::vector<int> all(k.stage.loops.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> margins;
  find_margins(d, all, margins);
  Check check;
  worst_margin(d, margins, check);
  return check.loop_without_digit < 0 ? nullptr : &k.stage.loops[at(check.loop_without_digit)];
}

/// Signals of the loop without a digit, or of the weakest pivot's; empty if there is neither.
std::vector<int> signals_without_digit(const Skeleton& k, const Factored& d) {
  if (const Loop* const loop = loop_without_digit(k, d)) return loop->signals;
  const int variable = d.factors->health().weakest_variable;
  const int signal = variable < 0 ? -1 : k.joint.variables[at(variable)];
  if (signal < 0) return {};
  for (const Loop& loop : k.stage.loops)
    if (std::find(loop.signals.begin(), loop.signals.end(), signal) != loop.signals.end())
      return loop.signals;
  return {signal};
}

}  // namespace

double least_pivot(const Factored& d, Check& check) {
  const Skeleton& k = *d.skeleton;
  if (!is_doubtful(check)) return 0;
  // Not after reduction: loops of the equations as written may then be singular.
  if (check.loop_without_digit >= 0 && !k.before_reduce) return kLeftOfZero;
  if (products(*k.joint.plan) > kMostProducts) {
    check.notes.push_back({Note::Kind::warning, "certify",
                           "it is not decided whether the solution of these equations has a digit "
                           "left: the diagram is too large for an elimination in 50 digits"});
    return 0;
  }
  if (!singular_in_50_digits(k, d)) return 0;
  return std::clamp(2 * check.certificate.weakest_pivot, kLeftOfZero, solve::kCancelled);
}

Mistake no_digit_left(const Skeleton& k, const Factored& d) {
  std::vector<std::string> ports;
  for (const int s : signals_without_digit(k, d)) ports.push_back(name_of(k.stage.graph, s));
  return {Code::ill_posed,
          fmt::format("the algebraic loop through {} has no unique solution, or none with a digit "
                      "in double",
                      ports.empty() ? "a sum of many terms" : some_names(ports)),
          {"no digit is left: in double a pivot there is rounding alone"},
          "break the direct feedthrough there: give one block of the loop a state, or change a "
          "gain"};
}

}  // namespace titop::detail
