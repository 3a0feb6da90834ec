#include <titop/compiler/simulate/steppers.hpp>
#include <unsupported/Eigen/MatrixFunctions>

namespace titop::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class Exact : public StepRule {
 public:
  Exact(MatrixXd Phi, MatrixXd G0, MatrixXd G1)
      : Phi_(std::move(Phi)), G0_(std::move(G0)), G1_(std::move(G1)) {}
  VectorXd step(const VectorXd& x, const VectorXd& u0, const VectorXd& u1) const override {
    VectorXd next = Phi_ * x;
    next.noalias() += G0_ * u0;
    next.noalias() += G1_ * (u1 - u0);
    return next;
  }

 private:
  MatrixXd Phi_, G0_, G1_;
};

/// Powers of two that give rows and columns of A the same size: positions in metres beside rates of
/// 1e5 would cost the exponential digits.
VectorXd balance(MatrixXd A) {
  VectorXd d = VectorXd::Ones(A.rows());
  A.diagonal().setZero();
  for (int sweep = 0; sweep < 10; ++sweep)
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const double c = A.col(i).cwiseAbs().sum(), r = A.row(i).cwiseAbs().sum();
      if (!(c > 0) || !(r > 0)) continue;
      const double f = std::exp2(std::round(std::log2(std::sqrt(r / c))));
      A.col(i) *= f;
      A.row(i) /= f;
      d(i) *= f;
    }
  return d;
}

}  // namespace

std::unique_ptr<StepRule> exact_rule(const System& system, double h) {
  StateSpace m;
  system.write(m);
  const auto n = m.A.rows(), nu = m.B.cols();
  const VectorXd d = balance(m.A);
  // d/dt [x; u; u'] with u linear in time: u' is what changes over one step, in units of steps.
  MatrixXd M = MatrixXd::Zero(n + 2 * nu, n + 2 * nu);
  M.topLeftCorner(n, n) = h * (d.cwiseInverse().asDiagonal() * m.A * d.asDiagonal());
  M.block(0, n, n, nu) = h * (d.cwiseInverse().asDiagonal() * m.B);
  M.block(n, n + nu, nu, nu).setIdentity();
  const MatrixXd E = M.exp();
  return std::make_unique<Exact>(
      d.asDiagonal() * E.topLeftCorner(n, n) * d.cwiseInverse().asDiagonal(),
      d.asDiagonal() * E.block(0, n, n, nu), d.asDiagonal() * E.block(0, n + nu, n, nu));
}

}  // namespace titop::detail
