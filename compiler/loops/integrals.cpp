#include <titop/compiler/loops/integrals.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::loops {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

struct IntegralFinder {
  const Graph& g;
  const Motion& motion;
  const SumExpander& sums;
  const StateRates& coordinates;
  ParameterValues values;
  std::map<int, std::optional<Integral>> found = {};

  std::optional<Integral> find(int node) {
    const auto [place, added] = found.try_emplace(node, std::nullopt);  // a ring of them: none
    if (!added) return place->second;
    const Node& n = g.nodes[at(node)];
    const ExpandedSum sum = sums.of_input(n.first_signal);
    auto result = sum.rates.empty() && sum.integrals.empty() && sum.states.empty()
                      ? of_accelerations(sum)
                  : sum.points.empty() ? of_rates(sum)
                                       : std::nullopt;
    if (result) result->node = node;
    return found[node] = std::move(result);
  }

  std::optional<Integral> of_accelerations(const ExpandedSum& sum) const {
    Integral result;
    for (const auto& [channel, c] : sum.points) add(result.form, c, motion.position(channel));
    for (const auto& [signal, c] : sum.others)
      add(result.form, {FormColumn::Kind::prescribed, signal, 0}, c);
    for (const auto& [column, matrix] : result.form)
      if (column.kind == FormColumn::Kind::states && !all_have_rates(column.id, matrix))
        return std::nullopt;  // it keeps its states
    return result;
  }

  bool all_have_rates(int node, const MatrixXd& matrix) const {
    for (Index j = 0; j < matrix.cols(); ++j)
      if (!matrix.col(j).isZero(0) && coordinates.rate_of(node, static_cast<int>(j)) < 0)
        return false;
    return true;
  }

  std::optional<Integral> of_rates(const ExpandedSum& sum) {
    Integral result;
    result.level = 2;
    for (const auto& [signal, c] : sum.integrals) {
      const auto inner = find(g.signals[at(signal)].node);
      if (!inner || inner->level != 1) return std::nullopt;
      add(result.form, c, inner->form);
    }
    for (const auto& [signal, c] : sum.rates) {
      const Signal& y = g.signals[at(signal)];
      const auto d = g.nodes[at(y.node)].block->dynamics(values);
      if (!d->D.middleRows(y.first, y.size).isZero(0) ||
          !add_positions(result.form, y.node, c * d->C.middleRows(y.first, y.size)))
        return std::nullopt;
    }
    for (const auto& [signal, c] : sum.states)
      if (!add_positions(result.form, g.signals[at(signal)].node, c)) return std::nullopt;
    for (const auto& [signal, c] : sum.others)
      add(result.form, {FormColumn::Kind::prescribed, signal, 1}, c);
    return result;
  }

  /// A reading of the rates of states (C, rows x states) as the same of these states themselves;
  /// false if it reads more.
  bool add_positions(Form& form, int node, MatrixXd C) const {
    MatrixXd result = MatrixXd::Zero(C.rows(), C.cols());
    for (Index j = 0; j < C.cols(); ++j)
      if (const int rate = coordinates.rate_of(node, static_cast<int>(j)); rate >= 0) {
        result.col(j) = C.col(rate);
        C.col(rate).setZero();
      }
    if (!C.isZero(0)) return false;
    add(form, {FormColumn::Kind::states, node}, result);
    return true;
  }
};

}  // namespace

std::vector<Integral> integrals(const Graph& g, const Motion& motion, const SumExpander& sums,
                                const StateRates& coordinates, ParameterValues values) {
  IntegralFinder finder{g, motion, sums, coordinates, values};
  std::vector<Integral> result;
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
    const Node& node = g.nodes[at(i)];
    if (!sums.is_integrator(i) || node.state < 0 || !g.signals[at(node.state)].active) continue;
    if (auto found = finder.find(i)) result.push_back(std::move(*found));
  }
  return result;
}

}  // namespace titop::loops
