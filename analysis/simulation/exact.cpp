#include <titop/analysis/simulation/hold.hpp>
#include <titop/analysis/simulation/steppers.hpp>

namespace titop::detail {

using Eigen::MatrixXd;
using Eigen::VectorXd;

ExactRule::ExactRule(const System& system, double h) : h_(h) {
  StateSpace m;
  system.write(m);
  A_ = std::move(m.A), B_ = std::move(m.B);
  const auto n = A_.rows(), nu = B_.cols();
  // Inputs that are linear in time are additional states, with constant slope: d/dt u = (u1-u0)/h.
  MatrixXd A = MatrixXd::Zero(n + nu, n + nu), slope = MatrixXd::Zero(n + nu, nu);
  A.topLeftCorner(n, n) = A_;
  A.topRightCorner(n, nu) = B_;
  slope.bottomRows(nu).diagonal().setConstant(1 / h);
  const Hold all = hold(A, slope, h);
  Phi_ = all.A.topLeftCorner(n, n);
  G0_ = all.A.topRightCorner(n, nu);
  G1_ = all.B.topRows(n);
  of_.compute(MatrixXd::Identity(n, n) - h / 2 * A_);
}

VectorXd ExactRule::step(const VectorXd& x, const VectorXd& u0, const VectorXd& u1) const {
  VectorXd next = Phi_ * x;
  next.noalias() += G0_ * u0;
  next.noalias() += G1_ * (u1 - u0);
  return next;
}

VectorXd ExactRule::step(const VectorXd& x, const VectorXd& u0, const VectorXd& u1,
                         VectorXd& other) const {
  MatrixXd both(x.size(), 2);
  both << x, other;
  both = Phi_ * both;
  other = both.col(1);
  VectorXd next = both.col(0);
  next.noalias() += G0_ * u0;
  next.noalias() += G1_ * (u1 - u0);
  return next;
}

VectorXd ExactRule::xdot(const VectorXd& x, const VectorXd& u) const {
  VectorXd result = A_ * x;
  result.noalias() += B_ * u;
  return result;
}

VectorXd ExactRule::of(const VectorXd& xdot) const { return h_ * of_.solve(xdot); }

}  // namespace titop::detail
