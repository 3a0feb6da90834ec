#include <titop/compiler/simulate/hold.hpp>
#include <titop/compiler/simulate/steppers.hpp>

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

}  // namespace

std::unique_ptr<StepRule> exact_rule(const System& system, double h) {
  StateSpace m;
  system.write(m);
  const auto n = m.A.rows(), nu = m.B.cols();
  // Inputs that are linear in time are states of their own, whose slope is held: d/dt u =
  // (u1-u0)/h.
  MatrixXd A = MatrixXd::Zero(n + nu, n + nu), slope = MatrixXd::Zero(n + nu, nu);
  A.topLeftCorner(n, n) = m.A;
  A.topRightCorner(n, nu) = m.B;
  slope.bottomRows(nu).diagonal().setConstant(1 / h);
  const Hold all = hold(A, slope, h);
  return std::make_unique<Exact>(all.A.topLeftCorner(n, n), all.A.topRightCorner(n, nu),
                                 all.B.topRows(n));
}

}  // namespace titop::detail
