#include <algorithm>
#include <numeric>
#include <titop/compiler/minreal/at_zero.hpp>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/compiler/minreal/integrators.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <titop/graph/name_order.hpp>

namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

using linalg::at;

MatrixXd above(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd both(a.rows() + b.rows(), a.cols());
  both << a, b;
  return both;
}

std::vector<std::string> above(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

IntegratorSplit find_integrators(const StateSpace& model) {
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
  IntegratorSplit states;
  for (int j = 0; j < n; ++j) (integrator[at(j)] ? states.integrators : states.rest).push_back(j);
  return states;
}

StateSpace without_integrators(const StateSpace& model, const IntegratorSplit& states) {
  StateSpace rest;
  rest.A = model.A(states.rest, states.rest);
  rest.B = model.B(states.rest, Eigen::all);
  rest.states = names_at(model.states, states.rest);
  rest.rates = names_at(model.rates, states.rest);
  rest.inputs = model.inputs;
  rest.outputs = model.outputs;
  MatrixXd C = model.C(Eigen::all, states.rest), D = model.D;
  if (model.outputs.empty()) {  // all states count, not only those that integrators read
    C = MatrixXd::Identity(rest.A.rows(), rest.A.cols());
    D = MatrixXd::Zero(rest.A.rows(), model.B.cols());
    rest.outputs = rest.states;
  }
  rest.C = above(C, model.A(states.integrators, states.rest));
  rest.D = above(D, model.B(states.integrators, Eigen::all));
  for (const int i : states.integrators) rest.outputs.push_back(model.states[at(i)] + "_rate");
  return rest;
}

StateSpace with_integrators(const StateSpace& rest, const StateSpace& model,
                            const IntegratorSplit& states) {
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
  m.states = above(rest.states, names_at(model.states, states.integrators));
  m.rates = above(rest.rates, names_at(model.rates, states.integrators));
  m.inputs = model.inputs;
  m.outputs = model.outputs;
  return m;
}

namespace {

/// X A_rest = taken + N X, if a power of N is 0: `divided(Y)` is Y A_rest^-1.
template <class Divided>
MatrixXd followed(const MatrixXd& N, const MatrixXd& taken, const Divided& divided) {
  MatrixXd X = MatrixXd::Zero(taken.rows(), taken.cols());
  for (Index step = 0; step < N.rows(); ++step) {
    const MatrixXd before = X;
    X = divided(MatrixXd(taken + N * X));
    if (!X.allFinite() || X == before) break;
  }
  return X;
}

}  // namespace

Decoupled decouple(const StateSpace& model, const IntegratorSplit& states) {
  const auto& [rest, integrators] = states;
  Decoupled d{MatrixXd::Zero(std::ssize(integrators), std::ssize(rest)),
              model.A(integrators, integrators), model.B(integrators, Eigen::all),
              model.C(Eigen::all, rest)};
  if (rest.empty()) return d;
  MatrixXd A = model.A(rest, rest);
  const Eigen::VectorXd scale = linalg::similarity_scaling_of_parts(A);
  const Eigen::PartialPivLU<MatrixXd> lu(MatrixXd(A.transpose()));
  const auto divided = [&](const MatrixXd& Y) {
    const MatrixXd right = Y.transpose();
    return MatrixXd(MatrixXd(lu.solve(right)).transpose());
  };
  const MatrixXd taken = model.A(integrators, rest) * scale.asDiagonal();
  d.X = followed(d.N, taken, divided) * scale.cwiseInverse().asDiagonal();
  d.B -= d.X * model.B(rest, Eigen::all);
  d.C_rest += model.C(Eigen::all, integrators) * d.X;
  return d;
}

namespace {

/// False if the other states have a pole so near 0 that it is 0 after rounding.
bool is_finite(const Decoupled& d) {
  return d.X.allFinite() && d.B.allFinite() && d.C_rest.allFinite();
}

}  // namespace

std::optional<StateSpace> decoupled_rest(const detail::Sampled& s, const IntegratorSplit& states) {
  if (has_pole_at_zero(s, states.rest)) return std::nullopt;
  const Decoupled d = decouple(s.model, states);
  if (!is_finite(d)) return std::nullopt;
  std::vector<Decoupled> samples;
  for (const StateSpace& off : s.off) {
    samples.push_back(decouple(off, states));
    if (!is_finite(samples.back())) return std::nullopt;
  }
  StateSpace rest = without_integrators(s.model, states);
  const MatrixXd terms = s.model.C(Eigen::all, states.rest).cwiseAbs() +
                         s.model.C(Eigen::all, states.integrators).cwiseAbs() * d.X.cwiseAbs();
  const MatrixXd rounding =
      detail::rounding_of(samples, d.C_rest, [](const Decoupled& part) { return part.C_rest; });
  rest.C = detail::cleared(d.C_rest, rounding.cwiseMax(kEpsilon * terms));
  rest.D = s.model.D;
  rest.outputs = s.model.outputs;
  return rest;
}

}  // namespace titop::minreal
