#include "generate/diagrams/random_diagram.hpp"

#include "generate/diagrams/draft.hpp"

namespace titop::generate {

using Eigen::MatrixXd;

Diagram RandomDiagram::build(const Units& units) const {
  Build b(name, units);
  for (const Step& step : adds) step(b);
  for (const Step& step : equations) step(b);
  return std::move(b.d);
}

Diagram RandomDiagram::shuffled(std::uint64_t seed) const {
  RandomDiagram other = *this;
  Rng rng(seed);
  rng.shuffle(other.adds);
  rng.shuffle(other.equations);
  return other.build();
}

Eigen::VectorXd RandomDiagram::factors(const std::vector<std::vector<Dim>>& dims,
                                       const Units& units) {
  std::vector<double> all;
  for (const auto& signal : dims)
    for (const Dim& dim : signal) all.push_back(dim.factor(units));
  return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

std::vector<Eigen::Index> RandomDiagram::blocks(const std::vector<std::vector<Dim>>& dims) {
  std::vector<Eigen::Index> result;
  for (const auto& signal : dims)
    for (std::size_t i = 0, step = signal.size() % 3 == 0 ? 3 : 1; i < signal.size(); i += step)
      result.push_back(static_cast<Eigen::Index>(step));
  return result;
}

std::vector<int> draw_tree(Draft& d, int count) {
  std::vector<int> parent{-1};
  for (int i = 1; i < count; ++i) parent.push_back(parent_of(d.options.shape, i, d.rng));
  return parent;
}

Root draw_root(Draft& d, int kinds) {
  const Root root = static_cast<Root>(d.rng.below(kinds));
  return root == Root::prescribed && !d.may_prescribe() ? Root::released : root;
}

std::string draw_filter(Draft& d, Dim in, Dim out, double gain, double direct) {
  const std::string name = d.fresh("K");
  const int n = 1 + d.rng.below(2);
  MatrixXd A = -MatrixXd::Identity(n, n) * d.rng.octaves(-1, 4);
  if (n == 2) A(0, 1) = d.rng.between(-2, 2), A(1, 0) = -A(0, 1);
  const MatrixXd B = d.rng.matrix(n, 1), C = gain * d.rng.matrix(1, n);
  d.add([=](Build& b) {
    const double t = b.units.time, q_in = in.factor(b.units), q_out = out.factor(b.units);
    b.filters.emplace(name,
                      b.d.add(name, Lti{.A = A / t,
                                        .B = B / (t * q_in),
                                        .C = C * q_out,
                                        .D = MatrixXd::Constant(1, 1, direct * q_out / q_in)}));
  });
  return name;
}

RandomOptions random_options(std::uint64_t seed, bool larger) {
  Rng rng(seed ^ 0x5EEDull);
  RandomOptions o;
  o.seed = seed;
  const int kind = rng.below(20);
  o.family = kind < 8 ? Family::scalar : kind < 14 ? Family::spatial : Family::mixed;
  o.shape = static_cast<Shape>(rng.below(3));
  const bool scalar = o.family == Family::scalar;
  o.bodies = 1 + rng.below(scalar ? (larger ? 30 : 12) : (larger ? 8 : 4));
  o.assemblies = rng.chance(0.25) ? 2 : 1;
  o.damping = static_cast<Damping>(rng.below(3));
  o.controllers = rng.chance(0.6);
  o.incomplete = rng.chance(0.2);
  return o;
}

RandomDiagram random_diagram(const RandomOptions& options) {
  Draft d(options);
  d.drawn.name = fmt::format("random {}", options.seed);
  const bool no_inputs = options.incomplete && d.rng.chance(0.1);
  const bool no_outputs = options.incomplete && d.rng.chance(0.1);
  for (int a = 0; a < options.assemblies; ++a) {
    const int count = a == 0 ? options.bodies : 1 + d.rng.below(options.bodies);
    // The first assembly has both, unless nothing in the diagram has.
    const bool bare = options.incomplete && a > 0;
    d.has_inputs = !no_inputs && !(bare && d.rng.chance(0.4));
    d.has_outputs = !no_outputs && !(bare && d.rng.chance(0.4));
    if (options.family == Family::scalar)
      draw_scalar(d, count);
    else
      draw_spatial(d, count, options.family == Family::mixed);
  }
  d.has_inputs = !no_inputs, d.has_outputs = !no_outputs;
  draw_controllers(d, options.large_controllers);
  return std::move(d.drawn);
}

}  // namespace titop::generate
