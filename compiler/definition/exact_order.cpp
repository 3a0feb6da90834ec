#include <fmt/format.h>

#include <titop/compiler/definition/exact/equations.hpp>
#include <titop/compiler/definition/exact_order.hpp>
#include <titop/graph/closed_form.hpp>

namespace titop {
namespace {

ExactOrder order_of(const exact::Model& m) {
  const exact::Echelon reachable = exact::krylov(m.A, m.B),
                       observable = exact::krylov(m.A_transposed, m.C);
  ExactOrder r;
  r.decided = true;
  r.states = m.states;
  r.reachable = reachable.rank();
  r.observable = observable.rank();
  r.order = exact::rank_of_products(observable, reachable);
  return r;
}

}  // namespace

ExactOrder exact_order(const Graph& graph, const ExactOptions& options, ParameterValues values) {
  if (!graph.mistakes.empty()) throw Error(graph.mistakes);
  require_state_space(graph);
  const std::vector<double> nominal = nominal_values(graph);
  try {
    if (graph.inputs.empty() || graph.outputs.empty())
      throw exact::Undecided{"without inputs, or without outputs, there is no transfer"};
    return order_of(exact::model_of(graph, options, values.empty() ? nominal : values));
  } catch (const exact::Undecided& u) {
    return {.why_not = u.why};
  }
}

ExactOrder exact_order(const StateSpace& model, const ExactOptions& options) {
  try {
    if (model.order() > options.states)
      throw exact::Undecided{fmt::format("{} states are more than {} (ExactOptions::states)",
                                         model.order(), options.states)};
    if (model.B.cols() == 0 || model.C.rows() == 0)
      throw exact::Undecided{"without inputs, or without outputs, there is no transfer"};
    return order_of(exact::model_of(model));
  } catch (const exact::Undecided& u) {
    return {.why_not = u.why};
  }
}

std::string to_string(const ExactOrder& r) {
  if (!r.decided) return "not decided exactly: " + r.why_not;
  return fmt::format("exact: order {} (of {} states, {} reachable, {} observable)", r.order,
                     r.states, r.reachable, r.observable);
}

}  // namespace titop
