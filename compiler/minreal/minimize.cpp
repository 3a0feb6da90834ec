#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <titop/compiler/minreal/at_zero.hpp>
#include <titop/compiler/minreal/effect.hpp>
#include <titop/compiler/minreal/integrators.hpp>
#include <titop/compiler/minreal/minimize.hpp>
#include <titop/compiler/minreal/take_out.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/name_order.hpp>

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
void minimize_by(Modes modes, const MinimizeOptions& options, Minimized& r) {
  const int order = r.model.order();
  std::vector<minreal::Verdict> verdicts = minreal::judge(modes.modes, options.resolution);
  bool agrees = true;
  if (options.exact_order >= 0)
    agrees = minreal::drop_down_to(options.exact_order, order, modes.modes, verdicts);
  r.order = minreal::sum_up(verdicts, modes.modes, order);
  if (options.exact_order >= 0) {
    r.order.exact = true;
    r.order.lowest = r.order.highest = options.exact_order;
  }
  if (!agrees)
    r.notes.push_back(
        fmt::format("{} states are kept although exact arithmetic needs {}: double precision does "
                    "not separate their modes",
                    r.order.order, options.exact_order));
  if (!r.order.removed.empty()) minreal::take_out(modes, verdicts, r.model, r.notes);
  r.notes.insert(r.notes.begin(), to_string(r.order));
}

/// All states, before any is judged.
Minimized as_a_whole(const StateSpace& model) {
  Minimized result;
  result.model = model;
  result.order.judged = true;
  result.order.order = result.order.lowest = result.order.highest = model.order();
  return result;
}

/// False, without a change, if the model has no symmetric form.
bool minimize_symmetric(const MinimizeOptions& options, Minimized& result) {
  auto s = minreal::symmetric_modes(result.model, options.resolution, options.energy);
  if (s) minimize_by(std::move(*s), options, result);
  return s.has_value();
}

Minimized minimize_as_it_stands(const StateSpace& model, const MinimizeOptions& options) {
  Minimized result = as_a_whole(model);
  if (model.order() == 0 || (model.inputs.empty() && model.outputs.empty())) return result;
  if (!minimize_symmetric(options, result))
    minimize_by(minreal::general_modes(model, options.resolution), options, result);
  return result;
}

/// `rest` and the integrators of the model, which act on each other no more.
StateSpace side_by_side(const StateSpace& rest, const StateSpace& model,
                        const minreal::IntegratorSplit& states) {
  StateSpace apart = model;
  apart.A(states.integrators, states.rest).setZero();
  StateSpace with_rates = rest;
  const Eigen::Index k = std::ssize(states.integrators), n = rest.A.rows();
  with_rates.C.conservativeResize(model.C.rows() + k, n);
  with_rates.C.bottomRows(k).setZero();
  with_rates.D.conservativeResize(model.C.rows() + k, model.B.cols());
  with_rates.D.bottomRows(k) = minreal::decouple(model, states).B;
  return minreal::with_integrators(with_rates, apart, states);
}

/// Minimizes the rest of a model whose integrators all count. Integrators keep their meaning if as
/// many modes can be removed without a change of their inputs.
Minimized minimize_beside(const detail::Sampled& sampled, const minreal::IntegratorSplit& states,
                          const StateSpace& rest, const MinimizeOptions& options) {
  const StateSpace& model = sampled.model;
  Minimized result = minimize_as_it_stands(rest, options);
  const Minimized coupled =
      minimize_as_it_stands(minreal::without_integrators(model, states),
                            {.resolution = options.resolution, .energy = options.energy});
  if (coupled.model.order() < result.model.order() && !result.order.exact) result = coupled;
  if (coupled.model.order() == result.model.order()) {
    result.notes = coupled.notes;
    result.model = minreal::with_integrators(coupled.model, model, states);
  } else {
    result.model = side_by_side(result.model, model, states);
    result.notes.push_back("integrators are those of the motion without the other states");
  }
  const int k = static_cast<int>(states.integrators.size());
  for (int* order : {&result.order.order, &result.order.lowest, &result.order.highest}) *order += k;
  return result;
}

/// Minimizes a model whose poles at 0 all count.
Minimized minimize_needed(const detail::Sampled& sampled, const MinimizeOptions& options) {
  MinimizeOptions of_rest = options;
  const minreal::IntegratorSplit states = minreal::find_integrators(sampled.model);
  if (states.integrators.empty()) return minimize_as_it_stands(sampled.model, of_rest);
  const int k = static_cast<int>(states.integrators.size());
  const auto rest = minreal::decoupled_rest(sampled, states);
  if (!rest || (options.exact_order >= 0 && options.exact_order < k))
    return minimize_as_it_stands(sampled.model, of_rest);
  if (options.exact_order >= 0) of_rest.exact_order = options.exact_order - k;
  if (options.energy.size() > 0) of_rest.energy = options.energy(states.rest, states.rest);
  return minimize_beside(sampled, states, *rest, of_rest);
}

/// Adds the verdict on states that have left to that on the others.
void add_removed(const minreal::RemovedStates& n, Minimized& r) {
  OrderVerdict& v = r.order;
  if (!v.exact) {
    v.lowest = std::max(0, v.lowest - static_cast<int>(n.doubtful.size()));
    v.highest += n.hidden;
  }
  for (const JudgedMode& mode : n.removed) v.to_more = std::max(v.to_more, mode.visibility);
  v.removed.insert(v.removed.begin(), n.removed.begin(), n.removed.end());
  v.undecided.insert(v.undecided.begin(), n.doubtful.begin(), n.doubtful.end());
  if (r.notes.empty()) r.notes.emplace_back();
  r.notes.insert(r.notes.begin() + 1, n.notes.begin(), n.notes.end());
  r.notes.front() = to_string(v);
}

Minimized minimize_in_order(const StateSpace& model, const MinimizeOptions& options) {
  if (model.inputs.empty() && model.outputs.empty()) return minimize_as_it_stands(model, options);
  detail::Sampled sampled = detail::sampled(model, options.rounding);
  MinimizeOptions of_rest{.resolution = options.resolution, .exact_order = options.exact_order};
  if (options.energy.rows() == model.A.rows()) of_rest.energy = options.energy;
  const minreal::RemovedStates by_pattern = minreal::take_out_by_pattern(sampled, of_rest.energy);
  Minimized result = as_a_whole(sampled.model);
  // Rigid motions of a symmetric form are modes at exactly 0.
  if (!minreal::find_integrators(sampled.model).integrators.empty() ||
      !minimize_symmetric(of_rest, result)) {
    const minreal::RemovedStates at_zero = minreal::take_out_at_zero(sampled, of_rest.energy);
    if (sampled.model.order() < options.exact_order) return minimize_as_it_stands(model, options);
    result = minimize_needed(sampled, of_rest);
    add_removed(at_zero, result);
  }
  add_removed(by_pattern, result);
  return result;
}

/// The rounding of a model's entries, with the model's names; empty if it has other sizes.
StateSpace fitting(const StateSpace& rounding, const StateSpace& model) {
  const auto same = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.rows() == b.rows() && a.cols() == b.cols();
  };
  if (!same(rounding.A, model.A) || !same(rounding.B, model.B) || !same(rounding.C, model.C) ||
      !same(rounding.D, model.D))
    return {};
  return {rounding.A,   rounding.B,   rounding.C,   rounding.D,
          model.states, model.inputs, model.outputs};
}

/// Modes are taken out by the names of states, and a model without names of ports has none.
void refuse_sizes(const StateSpace& m) {
  std::vector<Mistake> mistakes;
  const Eigen::Index n = std::ssize(m.states), nu = std::ssize(m.inputs),
                     ny = std::ssize(m.outputs);
  const auto compare = [&](const char* subject, const Eigen::MatrixXd& entries, Eigen::Index rows,
                           Eigen::Index columns) {
    if (entries.rows() == rows && entries.cols() == columns) return;
    mistakes.push_back(
        {Code::size,
         fmt::format("minimize: {} of the model is {} x {}, by its names it is {} x {}", subject,
                     entries.rows(), entries.cols(), rows, columns),
         {},
         "name every state, input and output of the model; A is n x n, B n x nu, "
         "C ny x n, D ny x nu"});
  };
  compare("A", m.A, n, n);
  compare("B", m.B, n, nu);
  compare("C", m.C, ny, n);
  compare("D", m.D, ny, nu);
  if (!m.rates.empty()) compare("rates", Eigen::MatrixXd(std::ssize(m.rates), 1), n, 1);
  if (!mistakes.empty()) throw Error(std::move(mistakes));
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
        fmt::format("; {} state{} removed, {}", left, left == 1 ? "" : "s", describe(v.removed));
  }
  if (v.to_fewer < 1)
    text += fmt::format("; removing the next mode would change the transfer by {:.1e}", v.to_fewer);
  if (v.change >= 0)
    text += fmt::format("; {} {:.1e}",
                        v.removed.empty() ? "no mode removed: removal changed the transfer by"
                                          : "transfer changed by",
                        v.change);
  return text;
}

Minimized minreal::minimize_unmeasured(const StateSpace& model, const MinimizeOptions& given) {
  refuse_sizes(model);
  if (!model.A.allFinite() || !model.B.allFinite() || !model.C.allFinite() || !model.D.allFinite())
    throw Error(Code::not_finite, "minimize: entries of the model are not finite",
                "look for overflow in the data");
  MinimizeOptions options = given;
  options.rounding = fitting(given.rounding, model);
  // By name, so that the last bits do not depend on the order in which the diagram was written.
  const std::optional<NameOrder> order = name_order(model);
  if (!order) return minimize_in_order(model, options);
  MinimizeOptions sorted = options;
  if (options.energy.rows() == model.A.rows())
    sorted.energy = options.energy(order->states, order->states);
  if (options.rounding.A.size() > 0) sorted.rounding = by_name(options.rounding, *order);
  Minimized result = minimize_in_order(by_name(model, *order), sorted);
  result.model = as_before(result.model, model.states, *order);
  return result;
}

Minimized minimize(const StateSpace& model, const MinimizeOptions& options) {
  Minimized result = minreal::minimize_unmeasured(model, options);
  minreal::measure_change(model, result);
  minreal::put_back(model, options.resolution, 0, result);
  return result;
}

}  // namespace titop
