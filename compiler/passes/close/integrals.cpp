#include <titop/compiler/passes/close/integrals.hpp>

namespace titop::passes::closing {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

struct Finder {
  const Graph& g;
  const Motion& motion;
  const Twins& twins;
  const Coordinates& coordinates;
  ParameterValues values;
  std::map<int, std::optional<Integral>> found = {};

  std::optional<Integral> find(int node) {
    const auto [place, added] = found.try_emplace(node, std::nullopt);  // a ring of them: none
    if (!added) return place->second;
    const Node& n = g.nodes[at(node)];
    const Twin twin = twins.of_input(n.first_signal);
    auto result = twin.rates.empty() && twin.integrals.empty() ? of_accelerations(twin)
                  : twin.points.empty()                        ? of_rates(twin)
                                                               : std::nullopt;
    if (result) result->node = node;
    return found[node] = std::move(result);
  }

  std::optional<Integral> of_accelerations(const Twin& twin) const {
    Integral result;
    for (const auto& [channel, c] : twin.points) add(result.form, c, motion.position(channel));
    for (const auto& [signal, c] : twin.others)
      add(result.form, {Column::Kind::prescribed, signal, 0}, c);
    return result;
  }

  std::optional<Integral> of_rates(const Twin& twin) {
    Integral result;
    result.level = 2;
    for (const auto& [signal, c] : twin.integrals) {
      const auto inner = find(g.signals[at(signal)].node);
      if (!inner || inner->level != 1) return std::nullopt;
      add(result.form, c, inner->form);
    }
    for (const auto& [signal, c] : twin.rates) {
      const auto own = angle_of(signal);
      if (!own) return std::nullopt;
      add(result.form, {Column::Kind::states, g.signals[at(signal)].node}, c * *own);
    }
    for (const auto& [signal, c] : twin.others)
      add(result.form, {Column::Kind::prescribed, signal, 1}, c);
    return result;
  }

  /// The output in terms of the position states, of which it shows the rates; none if it shows
  /// more.
  std::optional<MatrixXd> angle_of(int signal) const {
    const Signal& y = g.signals[at(signal)];
    const auto d = g.nodes[at(y.node)].block->dynamics(values);
    if (!d->D.middleRows(y.first, y.size).isZero(0)) return std::nullopt;
    MatrixXd C = d->C.middleRows(y.first, y.size), result = MatrixXd::Zero(y.size, C.cols());
    for (Index j = 0; j < C.cols(); ++j)
      if (const int rate = coordinates.rate_of(y.node, static_cast<int>(j)); rate >= 0) {
        result.col(j) = C.col(rate);
        C.col(rate).setZero();
      }
    return C.isZero(0) ? std::optional(result) : std::nullopt;
  }
};

}  // namespace

std::vector<Integral> integrals(const Graph& g, const Motion& motion, const Twins& twins,
                                const Coordinates& coordinates, ParameterValues values) {
  Finder finder{g, motion, twins, coordinates, values};
  std::vector<Integral> result;
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
    const Node& node = g.nodes[at(i)];
    if (!twins.is_integrator(i) || node.state < 0 || !g.signals[at(node.state)].active) continue;
    if (auto found = finder.find(i)) result.push_back(std::move(*found));
  }
  return result;
}

}  // namespace titop::passes::closing
