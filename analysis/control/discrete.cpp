#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <titop/analysis/control/discrete.hpp>
#include <titop/analysis/control/nyquist.hpp>
#include <titop/analysis/simulation/hold.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using std::numbers::pi;

StateSpace held_ramps(const StateSpace& m, double h) {
  const Index n = m.A.rows(), nu = m.B.cols();
  MatrixXd A = MatrixXd::Zero(n + nu, n + nu), B = MatrixXd::Zero(n + nu, nu);
  A.topLeftCorner(n, n) = m.A, A.topRightCorner(n, nu) = m.B;
  B.bottomRows(nu) = MatrixXd::Identity(nu, nu) / h;
  const Hold ramp = hold(A, B, h);
  // x(k + 1) = Phi x + G1 u(k) + G2 (u(k + 1) - u(k)); states x - G2 u.
  const MatrixXd Phi = ramp.A.topLeftCorner(n, n), G1 = ramp.A.topRightCorner(n, nu),
                 G2 = ramp.B.topRows(n);
  StateSpace d = m;
  d.A = Phi;
  d.B = G1 + Phi * G2 - G2;
  d.D = m.D + m.C * G2;
  return d;
}

/// The inverse, or singular.
MatrixXd inverted(const MatrixXd& M, const std::string& message, const char* way_out) {
  const linalg::Inverse inverse = linalg::equilibrated_inverse(M);
  if (M.rows() > 0 && !(inverse.rcond > static_cast<double>(M.rows()) * linalg::kEpsilon))
    throw Error(Code::singular, message, way_out);
  return inverse.matrix;
}

/// s = c (z - 1) / (z + 1).
StateSpace bilinear(const StateSpace& m, double c) {
  const MatrixXd I = MatrixXd::Identity(m.A.rows(), m.A.rows());
  const MatrixXd M = inverted(c * I - m.A, fmt::format("Tustin's rule: {:.6g} rad/s is a pole", c),
                              "take another period");
  StateSpace d = m;
  d.A = M * (c * I + m.A);
  d.B = std::sqrt(2 * c) * M * m.B;
  d.C = std::sqrt(2 * c) * m.C * M;
  d.D = m.D + m.C * M * m.B;
  return d;
}

/// z = (c + w) / (c - w), the inverse of `bilinear`.
StateSpace on_axis(const StateSpace& m, double c) {
  const MatrixXd I = MatrixXd::Identity(m.A.rows(), m.A.rows());
  const MatrixXd N = inverted(m.A + I, "the discrete loop transfer has a pole at z = -1",
                              "a law that changes sign at every step has no margin");
  StateSpace w = m;
  w.A = c * N * (m.A - I);
  w.B = std::sqrt(2 * c) * N * m.B;
  w.C = std::sqrt(2 * c) * m.C * N;
  w.D = m.D - m.C * N * m.B;
  // L(-1) of Tustin's rule for a loop without a direct term: 0 by cancellation.
  const MatrixXd terms = m.D.cwiseAbs() + m.C.cwiseAbs() * N.cwiseAbs() * m.B.cwiseAbs();
  w.D = (w.D.array().abs() <= linalg::kProductRounding * terms.array()).select(0.0, w.D);
  w.rates.clear();
  return w;
}

void check_prewarp(double prewarp, double period, Discretization method) {
  if (prewarp == 0) return;
  if (method != Discretization::tustin || !(prewarp > 0) || !(prewarp * period < pi))
    throw Error(Code::bad_value, fmt::format("a prewarp frequency of {} rad/s", prewarp),
                fmt::format("give one between 0 and pi / period = {:.6g} rad/s, with Tustin's rule",
                            pi / period));
}

/// Frequencies of the axis as those of the unit circle.
class Unwarp {
 public:
  explicit Unwarp(double period) : period_(period) {}
  void operator()(double& omega) const { omega = 2 / period_ * std::atan(omega * period_ / 2); }
  void operator()(LoopMargins& m) const {
    for (MarginAt* at : {&m.larger_gain, &m.smaller_gain, &m.phase, &m.nearest}) (*this)(at->omega);
    (*this)(m.disk.omega);
    for (auto* list : {&m.unit, &m.negative})
      for (LoopCrossing& c : *list) (*this)(c.omega);
    if (m.delay.value == 0) return;  // not stable
    m.delay = {std::numeric_limits<double>::infinity(), 0};
    for (const LoopCrossing& c : m.unit) {
      const double ahead = std::arg(-c.L), lag = ahead < 0 ? ahead + 2 * pi : ahead;
      if (lag / c.omega < m.delay.value) m.delay = {lag / c.omega, c.omega};
    }
  }

 private:
  double period_;
};

}  // namespace

DiscreteModel discretize(const StateSpace& model, double period, Discretization method,
                         double prewarp) {
  require_fitting(model, "discretize");
  if (!(period > 0) || std::isinf(period))
    throw Error(Code::bad_value, fmt::format("a period of {} s", period),
                "give a positive, finite time in seconds");
  check_prewarp(prewarp, period, method);
  DiscreteModel d{model, period};
  if (method == Discretization::tustin) {
    d.model = bilinear(model, prewarp > 0 ? prewarp / std::tan(prewarp * period / 2) : 2 / period);
  } else if (method == Discretization::first_order_hold) {
    d.model = held_ramps(model, period);
  } else {
    const Hold h = hold(model.A, model.B, period);
    d.model.A = h.A, d.model.B = h.B;
  }
  d.model.rates.clear();
  return d;
}

DiscreteModel series(const DiscreteModel& first, const DiscreteModel& second) {
  const StateSpace &a = first.model, &b = second.model;
  require_fitting(a, "series");
  require_fitting(b, "series");
  if (a.C.rows() != b.B.cols())
    throw Error(Code::size, fmt::format("{} outputs into {} inputs", a.C.rows(), b.B.cols()),
                "the second model takes all outputs of the first");
  if (first.period != second.period)
    throw Error(Code::bad_value,
                fmt::format("periods of {} s and {} s", first.period, second.period),
                "discretize both at one period");
  const Index n = a.A.rows(), k = b.A.rows();
  StateSpace s;
  s.A = MatrixXd::Zero(n + k, n + k);
  s.A.topLeftCorner(n, n) = a.A, s.A.bottomRightCorner(k, k) = b.A;
  s.A.bottomLeftCorner(k, n) = b.B * a.C;
  s.B.resize(n + k, a.B.cols()), s.C.resize(b.C.rows(), n + k);
  s.B << a.B, b.B * a.D;
  s.C << b.D * a.C, b.C;
  s.D = b.D * a.D;
  s.states = a.states, s.inputs = a.inputs, s.outputs = b.outputs;
  s.states.insert(s.states.end(), b.states.begin(), b.states.end());
  return {std::move(s), first.period};
}

Margins margins(const DiscreteModel& L) {
  require_fitting(L.model, "margins");
  if (!(L.period > 0) || std::isinf(L.period))
    throw Error(Code::bad_value, fmt::format("a period of {} s", L.period),
                "give a positive, finite time in seconds");
  Margins m = detail::margins_of(on_axis(L.model, 2 / L.period), 0, L.period);
  const Unwarp unwarp(L.period);
  unwarp(m.disk.omega);
  unwarp(m.nearest.omega);
  for (LoopMargins& one : m.loops) unwarp(one);
  return m;
}

Lti pade(double delay, int order) {
  if (!(delay > 0) || std::isinf(delay) || order < 1 || order > 10)
    throw Error(Code::bad_value,
                fmt::format("a Pade approximation of order {} of a delay of {} s", order, delay),
                "give a positive, finite delay in seconds, and an order from 1 to 10");
  // Sum of c_i (-+ s delay)^i, c_i = (2 n - i)! n! / ((2 n)! i! (n - i)!); with x = s delay the
  // companion form of the denominator, in chains x_i' = x_{i+1}.
  const Index n = order;
  Eigen::VectorXd c(n + 1);
  c(0) = 1;
  for (Index i = 1; i <= n; ++i)
    c(i) = c(i - 1) * static_cast<double>(n - i + 1) / static_cast<double>((2 * n - i + 1) * i);
  MatrixXd A = MatrixXd::Zero(n, n), B = MatrixXd::Zero(n, 1), C(1, n);
  const double direct = n % 2 == 0 ? 1 : -1;
  for (Index i = 0; i < n; ++i) {
    if (i + 1 < n) A(i, i + 1) = 1;
    A(n - 1, i) = -c(i) / c(n);
    C(0, i) = ((i % 2 == 0 ? 1 : -1) - direct) * c(i) / c(n);
  }
  B(n - 1, 0) = 1;
  return {.A = A / delay, .B = B / delay, .C = C, .D = MatrixXd::Constant(1, 1, direct)};
}

}  // namespace titop
