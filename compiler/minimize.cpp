#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <titop/compiler/minimize.hpp>
#include <titop/compiler/minimize/integrators.hpp>
#include <titop/compiler/minimize/take_out.hpp>
#include <titop/compiler/name_order.hpp>

namespace titop {
namespace {

int states_of(const std::vector<JudgedMode>& modes) {
  int count = 0;
  for (const JudgedMode& m : modes) count += m.states;
  return count;
}

/// "3 modes, the most visible at 11.4 rad/s: no output sees it (visibility 1e-12, rounding 1e-11)".
std::string describe(const std::vector<JudgedMode>& modes) {
  const auto most = std::max_element(
      modes.begin(), modes.end(),
      [](const JudgedMode& a, const JudgedMode& b) { return a.visibility < b.visibility; });
  return fmt::format(
      "{} at {:.5g} rad/s: {} (visibility {:.1e}, rounding {:.1e})",
      modes.size() == 1 ? "the mode" : fmt::format("{} modes, the most visible", modes.size()),
      most->omega, most->why, most->visibility, most->bound);
}

/// Judges, takes out and reports for either kind of modes.
template <class Modes>
void minimize_by(const Modes& modes, const MinimizeOptions& options, Minimized& r) {
  const int order = r.model.order();
  std::vector<modes::Verdict> verdicts = modes::judge(modes.modes, options.resolution);
  bool agrees = true;
  if (options.exact_order >= 0)
    agrees = modes::drop_down_to(options.exact_order, order, modes.modes, verdicts);
  r.order = modes::sum_up(verdicts, modes.modes, order);
  if (options.exact_order >= 0) {
    r.order.exact = true;
    r.order.lowest = r.order.highest = options.exact_order;
  }
  if (!agrees)
    r.notes.push_back(fmt::format(
        "{} states stay where exact arithmetic needs {}: in double their modes are not apart",
        r.order.order, options.exact_order));
  if (!r.order.removed.empty()) modes::take_out(modes, verdicts, r.model, r.notes);
  r.notes.insert(r.notes.begin(), to_string(r.order));
}

Minimized minimize_as_it_stands(const StateSpace& model, const MinimizeOptions& options) {
  Minimized result;
  result.model = model;
  result.order.judged = true;
  result.order.order = result.order.lowest = result.order.highest = model.order();
  if (model.order() == 0 || (model.inputs.empty() && model.outputs.empty())) return result;
  if (const auto s = modes::symmetric_modes(model, options.resolution, options.energy))
    minimize_by(*s, options, result);
  else
    minimize_by(modes::general_modes(model, options.resolution), options, result);
  return result;
}

/// Both verdicts, of which the second is on what the first has left.
void add_first(const Minimized& first, Minimized& r) {
  OrderVerdict& v = r.order;
  const OrderVerdict& before = first.order;
  v.lowest -= before.order - before.lowest;
  v.highest += before.highest - before.order;
  v.to_more = std::max(v.to_more, before.to_more);
  v.removed.insert(v.removed.begin(), before.removed.begin(), before.removed.end());
  v.undecided.insert(v.undecided.begin(), before.undecided.begin(), before.undecided.end());
  r.notes.insert(r.notes.begin() + 1, first.notes.begin() + 1, first.notes.end());
  r.notes.front() = to_string(v);
}

/// Integrators that nothing depends on are left out at first: beside their poles at 0 the other
/// modes have no symmetric form, and eigenvectors keep few digits.
Minimized minimize_in_order(const StateSpace& model, const MinimizeOptions& options) {
  const modes::Integrated states = modes::find_integrators(model);
  if (states.integrators.empty() || states.rest.empty() || options.exact_order >= 0)
    return minimize_as_it_stands(model, options);
  MinimizeOptions of_rest = options;
  if (options.energy.rows() == model.A.rows())
    of_rest.energy = options.energy(states.rest, states.rest);
  const Minimized first = minimize_as_it_stands(without_integrators(model, states), of_rest);
  if (first.order.removed.empty()) return minimize_as_it_stands(model, options);
  Minimized result = minimize_as_it_stands(with_integrators(first.model, model, states),
                                           {.resolution = options.resolution});
  add_first(first, result);
  return result;
}

}  // namespace

std::string to_string(const OrderVerdict& v) {
  if (!v.judged) return fmt::format("order {}: by structure only, effects not judged", v.order);
  std::string text = fmt::format("{}order {}", v.exact ? "exact: " : "", v.order);
  if (v.exact && v.lowest != v.order) text += fmt::format(", {} would do", v.lowest);
  if (!v.decided()) {
    text += fmt::format(", undecided between {} and {} at this precision", v.lowest, v.highest);
    if (!v.undecided.empty()) text += ", kept " + describe(v.undecided);
  }
  if (!v.removed.empty()) {
    const int left = states_of(v.removed);
    text +=
        fmt::format("; {} state{} taken out, {}", left, left == 1 ? "" : "s", describe(v.removed));
  }
  if (v.to_fewer < 1) text += fmt::format("; the next would cost {:.1e}", v.to_fewer);
  if (v.change >= 0)
    text += fmt::format(
        "; {} {:.1e}",
        v.removed.empty() ? "put back what changed the transfer by" : "transfer changed by",
        v.change);
  return text;
}

Minimized minimize(const StateSpace& model, const MinimizeOptions& options) {
  // By name, so that the last bits do not depend on the order in which the diagram was written.
  const std::optional<NameOrder> order = name_order(model);
  if (!order) return minimize_in_order(model, options);
  MinimizeOptions sorted = options;
  if (options.energy.rows() == model.A.rows())
    sorted.energy = options.energy(order->states, order->states);
  Minimized result = minimize_in_order(by_name(model, *order), sorted);
  result.model = as_before(result.model, model.states, *order);
  return result;
}

}  // namespace titop
