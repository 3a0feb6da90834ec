#include "generate/diagrams/draft.hpp"
#include "generate/diagrams/lti.hpp"

/// Controllers of 3 to 12 states and several inputs and outputs around the diagram drawn before.
namespace titop::generate {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

using Dims = std::vector<Dim>;
using Read = std::function<Expr(Build&)>;

std::string one_of(Draft& d, const std::vector<std::string>& names) {
  return names[static_cast<std::size_t>(d.rng.below(static_cast<int>(names.size())))];
}

/// The matrices as they are in other units: seconds, and a unit for each input and output.
Lti in_units(Lti K, const Dims& in, const Dims& out, const Units& units) {
  K.A /= units.time, K.B /= units.time;
  for (std::size_t j = 0; j < in.size(); ++j) {
    const auto column = static_cast<Index>(j);
    K.B.col(column) /= in[j].factor(units);
    if (K.D.size()) K.D.col(column) /= in[j].factor(units);
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto row = static_cast<Index>(i);
    K.C.row(row) *= out[i].factor(units);
    if (K.D.size()) K.D.row(row) *= out[i].factor(units);
  }
  return K;
}

/// One scalar that a controller may measure: an input, a stretch, an acceleration along an axis, or
/// the output of a controller before it.
Read draw_reading(Draft& d, Dims& in, const std::string& before) {
  const int kind = d.rng.below(4);
  const bool springs = !d.springs.empty() && (d.bodies.empty() || d.rng.chance(0.5));
  if (kind == 0 && d.has_inputs) {
    const std::string u = d.input({kForce});
    in.push_back(kForce);
    return [=](Build& b) { return b.inputs.at(u).expr(); };
  }
  if (kind == 1 && !before.empty()) {
    in.push_back(kForce);
    const MatrixXd first = MatrixXd::Identity(1, d.controller_outputs.at(before));
    return [=](Build& b) { return first * b.filters.at(before).out; };
  }
  if (springs) {
    const std::string z = one_of(d, d.springs);
    in.push_back(kind == 2 ? kLength : kAccel);
    if (kind == 2) return [=](Build& b) { return b.springs.at(z).stretch.expr(); };
    return [=](Build& b) { return b.springs.at(z).child.accel.expr(); };
  }
  const std::string a = one_of(d, d.bodies);
  in.push_back(kAccel);
  const Eigen::Vector3d r = Eigen::Vector3d::Unit(d.rng.below(3));
  return [=](Build& b) { return b.bodies.at(a).child("T").accel.along(r).expr(); };
}

/// Pushes with row `i` of K's outputs, a hundredth of a force for each unit of the measurement, so
/// that no loop becomes singular.
void draw_push(Draft& d, const std::string& K, Index i, Index outputs) {
  const MatrixXd row = 0.01 * MatrixXd::Identity(outputs, outputs).row(i);
  if (!d.springs.empty() && (d.bodies.empty() || d.rng.chance(0.5))) {
    const std::string z = one_of(d, d.springs);
    d.equation([=](Build& b) { b.springs.at(z).child.force += row * b.filters.at(K).out; });
    return;
  }
  const std::string a = one_of(d, d.bodies);
  const Eigen::Vector3d r = Eigen::Vector3d::Unit(d.rng.below(3));
  d.equation(
      [=](Build& b) { b.bodies.at(a).child("T").force.along(r) += row * b.filters.at(K).out; });
}

}  // namespace

void draw_controllers(Draft& d, int count) {
  std::string before;
  for (int k = 0; k < count; ++k) {
    const int n = 3 + d.rng.below(10), inputs = 1 + d.rng.below(3), outputs = 1 + d.rng.below(3);
    const Lti K = random_lti(d.rng, kLtiKinds[d.rng.below(6)], n, inputs, outputs);
    const std::string name = d.fresh("W");
    Dims in;
    const Dims out(static_cast<std::size_t>(outputs), kForce);
    std::vector<Read> read;
    for (int j = 0; j < inputs; ++j) read.push_back(draw_reading(d, in, before));
    d.add([=](Build& b) { b.filters.emplace(name, b.d.add(name, in_units(K, in, out, b.units))); });
    d.equation([=](Build& b) {
      const MatrixXd one = MatrixXd::Identity(inputs, inputs);
      Expr sum;
      for (int j = 0; j < inputs; ++j) {
        const Expr part = one.col(j) * read[static_cast<std::size_t>(j)](b);
        sum = j == 0 ? part : sum + part;
      }
      b.filters.at(name).in = sum;
    });
    if (d.rng.chance(0.7))  // else it only measures
      for (int i = 0; i < outputs; ++i) draw_push(d, name, i, outputs);
    if (d.has_outputs) d.output(out, [=](Build& b) { return b.filters.at(name).out.expr(); });
    d.controller_outputs.emplace(name, outputs);
    before = name;
  }
}

}  // namespace titop::generate
