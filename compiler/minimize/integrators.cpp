#include <algorithm>
#include <numeric>
#include <titop/compiler/minimize/integrators.hpp>

namespace titop::modes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

MatrixXd above(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd both(a.rows() + b.rows(), a.cols());
  both << a, b;
  return both;
}

}  // namespace

Integrated find_integrators(const StateSpace& model) {
  const Index n = model.A.rows();
  std::vector<char> integrator(at(n), 0);
  const auto acts_on_the_rest = [&](Index j) {
    for (Index i = 0; i < n; ++i)
      if (model.A(i, j) != 0 && !integrator[at(i)]) return true;
    return false;
  };
  for (bool found = true; found;) {
    found = false;
    for (Index j = 0; j < n; ++j)
      if (!integrator[at(j)] && !acts_on_the_rest(j)) integrator[at(j)] = found = true;
  }
  Integrated states;
  for (int j = 0; j < n; ++j) (integrator[at(j)] ? states.integrators : states.rest).push_back(j);
  return states;
}

StateSpace without_integrators(const StateSpace& model, const Integrated& states) {
  StateSpace rest;
  rest.A = model.A(states.rest, states.rest);
  rest.B = model.B(states.rest, Eigen::all);
  rest.C = above(model.C(Eigen::all, states.rest), model.A(states.integrators, states.rest));
  rest.D = above(model.D, model.B(states.integrators, Eigen::all));
  for (const int i : states.rest) rest.states.push_back(model.states[at(i)]);
  rest.inputs = model.inputs;
  rest.outputs = model.outputs;
  for (const int i : states.integrators) rest.outputs.push_back(model.states[at(i)] + "_rate");
  return rest;
}

StateSpace with_integrators(const StateSpace& rest, const StateSpace& model,
                            const Integrated& states) {
  const Index n = rest.A.rows(), k = std::ssize(states.integrators), outputs = model.C.rows();
  StateSpace m;
  m.A = MatrixXd::Zero(n + k, n + k);
  m.A.topLeftCorner(n, n) = rest.A;
  m.A.bottomLeftCorner(k, n) = rest.C.bottomRows(k);
  m.A.bottomRightCorner(k, k) = model.A(states.integrators, states.integrators);
  m.B = above(rest.B, rest.D.bottomRows(k));
  m.C.resize(outputs, n + k);
  m.C << rest.C.topRows(outputs), model.C(Eigen::all, states.integrators);
  m.D = rest.D.topRows(outputs);
  m.states = rest.states;
  for (const int i : states.integrators) m.states.push_back(model.states[at(i)]);
  m.inputs = model.inputs;
  m.outputs = model.outputs;
  return m;
}

}  // namespace titop::modes
