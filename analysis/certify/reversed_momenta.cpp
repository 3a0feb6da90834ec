#include <memory>
#include <titop/analysis/certify/dual_transfers.hpp>
#include <titop/analysis/certify/reversed_momenta.hpp>
#include <titop/compiler/passes/check/springs.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::certification {

using linalg::at;

std::optional<Graph> reversed_momenta(const Graph& graph, ParameterValues values) {
  const passes::ForceGains gyroscopic = passes::gyroscopic_gains(graph, values);
  if (gyroscopic.empty()) return {};
  Graph result = graph;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) result.parameters[i].value = values[i];
  for (const auto& [channels, gain] : gyroscopic) {
    const double sign = is_outward(graph, channels.first) ? 1 : -1;
    const auto twice = std::make_shared<const Eigen::MatrixXd>(-2 * sign * gain);
    result.equations.push_back({.target = graph.channels[at(channels.first)].force,
                                .accumulate = true,
                                .terms = {{.signal = graph.channels[at(channels.second)].accel,
                                           .of = Term::Of::rate,
                                           .factors = {Matrix{twice, nullptr}}}}});
  }
  return result;
}

std::vector<Eigen::MatrixXcd> with_reversed_momenta(
    const Graph& graph, ParameterValues values, Options options, const passes::DualPairs& pairs,
    const std::vector<std::complex<double>>& points) {
  const std::optional<Graph> reversed = reversed_momenta(graph, values);
  if (!reversed) return {};
  options.minimize_up_to = 0;
  options.dump_to.clear();
  const System system(detail::compile_graph(*reversed, options));
  std::vector<Eigen::MatrixXcd> transfers;
  for (const std::complex<double> s : points) transfers.push_back(system.transfer(s));
  return dual_transfers(pairs, points, transfers).G;
}

}  // namespace titop::certification
