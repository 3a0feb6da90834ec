#include <algorithm>
#include <titop/compiler/loops/expanded_sum.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::loops {
namespace {

using linalg::at;

/// Adds the coefficient of `key`.
void add_coefficient(std::map<int, Eigen::MatrixXd>& to, int key, const Eigen::MatrixXd& matrix) {
  const auto [place, added] = to.try_emplace(key, matrix);
  if (!added) place->second += matrix;
}

}  // namespace

SumExpander::SumExpander(const Graph& graph) : g_(graph), equation_of_(graph.signals.size(), -1) {
  for (int e = 0; e < static_cast<int>(graph.equations.size()); ++e)
    if (const int target = graph.equations[at(e)].target; graph.signals[at(target)].channel < 0)
      equation_of_[at(target)] = e;
}

bool SumExpander::is_integrator(int node) const {
  return node >= 0 && g_.nodes[at(node)].block->type() == "Integrator";
}

void SumExpander::add(ExpandedSum& to, const Eigen::MatrixXd& factor, int signal,
                      std::vector<int>& way) const {
  if (factor.isZero(0)) return;
  const Signal& s = g_.signals[at(signal)];
  if (s.channel >= 0 && s.quantity == Quantity::acceleration)
    return add_coefficient(to.points, s.channel, factor);
  const bool lowered = s.node >= 0 && g_.nodes[at(s.node)].lowered;
  if (const int e = equation_of_[at(signal)];
      lowered && e >= 0 && std::find(way.begin(), way.end(), signal) == way.end()) {
    way.push_back(signal);
    for (const Term& t : g_.equations[at(e)].terms)
      add(to, factor * coefficient(g_, t, {}), t.signal, way);
    way.pop_back();
    return;
  }
  if (s.role == Signal::Role::state)
    add_coefficient(to.states, signal, factor);
  else if (s.role == Signal::Role::output && is_integrator(s.node))
    add_coefficient(to.integrals, signal, factor);
  else if (s.role == Signal::Role::output && s.quantity == Quantity::velocity)
    add_coefficient(to.rates, signal, factor);
  else
    add_coefficient(to.others, signal, factor);
}

ExpandedSum SumExpander::of(const std::vector<Term>& terms) const {
  ExpandedSum result;
  std::vector<int> way;
  for (const Term& t : terms) add(result, coefficient(g_, t, {}), t.signal, way);
  return result;
}

ExpandedSum SumExpander::of_input(int signal) const {
  const int e = equation_of_[at(signal)];
  return e < 0 ? ExpandedSum{} : of(g_.equations[at(e)].terms);
}

}  // namespace titop::loops
