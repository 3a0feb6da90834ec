#include "support/random_scene.hpp"

#include <titop/graph/linalg/eigen.hpp>

#include "support/random_draft.hpp"

namespace titop_test {

using Eigen::MatrixXd;
using namespace titop;

double Dim::factor(const Units& u) const {
  return std::pow(u.length, length) * std::pow(u.mass, mass) * std::pow(u.time, time);
}

Diagram Scene::build(const Units& units) const {
  Build b(name, units);
  for (const Step& step : adds) step(b);
  for (const Step& step : equations) step(b);
  return std::move(b.d);
}

Diagram Scene::shuffled(std::uint64_t seed) const {
  Scene other = *this;
  Rng rng(seed);
  rng.shuffle(other.adds);
  rng.shuffle(other.equations);
  return other.build();
}

Eigen::VectorXd Scene::factors(const std::vector<std::vector<Dim>>& dims, const Units& units) {
  std::vector<double> all;
  for (const auto& signal : dims)
    for (const Dim& dim : signal) all.push_back(dim.factor(units));
  return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

std::vector<Eigen::Index> Scene::blocks(const std::vector<std::vector<Dim>>& dims) {
  std::vector<Eigen::Index> result;
  for (const auto& signal : dims)
    for (std::size_t i = 0, step = signal.size() % 3 == 0 ? 3 : 1; i < signal.size(); i += step)
      result.push_back(static_cast<Eigen::Index>(step));
  return result;
}

std::vector<int> draw_tree(Draft& d, int count) {
  std::vector<int> parent;
  for (int i = 0; i < count; ++i)
    parent.push_back(d.options.shape == Shape::chain  ? i - 1
                     : d.options.shape == Shape::star ? (i == 0 ? -1 : 0)
                                                      : (i == 0 ? -1 : d.rng.below(i)));
  return parent;
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

ModalData random_modes(Rng& rng, int modes, const std::vector<std::string>& children, bool damped) {
  const double m = rng.octaves(-1, 4), radius = rng.between(0.3, 1);
  const Vector3d parts = Vector3d::Constant(0.2) + rng.matrix(3, 1).cwiseAbs();
  const Matrix3d T = rng.rotation();
  const Vector3d principal(parts(0) + parts(1), parts(1) + parts(2), parts(2) + parts(0));
  const Matrix3d inertia = m * radius * radius * T * principal.asDiagonal() * T.transpose();
  ModalData data;
  data.D_P = rigid_mass(m, (inertia + inertia.transpose()) / 2, rng.matrix(3, 1));
  data.omega.resize(modes);
  data.xi.resize(modes);
  for (int i = 0; i < modes; ++i) {
    data.omega(i) = rng.octaves(0, 7);
    data.xi(i) = damped ? rng.between(0.005, 0.02) : 0;
  }
  const MatrixXd share = rng.matrix(modes, 6);
  const MatrixXd root = data.D_P.llt().matrixU();
  data.L_P = modes ? MatrixXd(0.8 / std::sqrt(share.squaredNorm()) * share * root) : MatrixXd(0, 6);
  for (const std::string& child : children) {
    MatrixXd Phi = rng.matrix(6, modes) / std::sqrt(m);
    Phi.bottomRows(3) /= radius;
    data.children.push_back({child, 2 * rng.matrix(3, 1), Phi});
  }
  return data;
}

ModalData scaled(ModalData data, const Units& u) {
  Vector6 length = Vector6::Ones();
  length.tail<3>().setConstant(u.length);
  const double root = std::sqrt(u.mass);
  data.omega /= u.time;
  data.L_P = root * data.L_P * length.asDiagonal();
  data.D_P = u.mass * length.asDiagonal() * data.D_P * length.asDiagonal();
  for (ModalChild& c : data.children) {
    c.PC *= u.length;
    c.Phi_C = length.cwiseInverse().asDiagonal() * c.Phi_C / root;
  }
  return data;
}

SceneOptions random_options(std::uint64_t seed, bool larger) {
  Rng rng(seed ^ 0x5EEDull);
  SceneOptions o;
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

Scene random_scene(const SceneOptions& options) {
  Draft d(options);
  d.scene.name = fmt::format("random {}", options.seed);
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
  return std::move(d.scene);
}

}  // namespace titop_test
