#pragma once

#include <memory>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/linalg/eigen.hpp>

/// One step of each method. For the library's own files only.
namespace titop::detail {

/// x at the end of a step from x at its beginning and the inputs at both ends.
class StepRule {
 public:
  virtual ~StepRule() = default;
  virtual Eigen::VectorXd step(const Eigen::VectorXd& x, const Eigen::VectorXd& u0,
                               const Eigen::VectorXd& u1) const = 0;
};

/// x1 = Phi x + G0 u0 + G1 (u1 - u0), from one exponential of order n + 2 m.
class ExactRule : public StepRule {
 public:
  ExactRule(const System& system, double h);
  Eigen::VectorXd step(const Eigen::VectorXd& x, const Eigen::VectorXd& u0,
                       const Eigen::VectorXd& u1) const override;
  /// The same, and the free motion from `other`: one pass through memory for both.
  Eigen::VectorXd step(const Eigen::VectorXd& x, const Eigen::VectorXd& u0,
                       const Eigen::VectorXd& u1, Eigen::VectorXd& other) const;
  /// A x + B u by the dense matrices of the steps.
  Eigen::VectorXd xdot(const Eigen::VectorXd& x, const Eigen::VectorXd& u) const;
  /// Effect of an error of xdot in one step: h (1 - h A / 2)^-1 of it, so that modes much faster
  /// than the step have their true effect, 2 / omega.
  Eigen::VectorXd of(const Eigen::VectorXd& xdot) const;

 private:
  double h_;
  Eigen::MatrixXd A_, B_, Phi_, G0_, G1_;
  Eigen::PartialPivLU<Eigen::MatrixXd> of_;
};
/// x1 = 2 x_m - x with (2 / h - A) x_m = (2 / h) x + B (u0 + u1) / 2, by the factors at s = 2 / h.
std::unique_ptr<StepRule> midpoint_rule(const Factored& data, double h);
std::unique_ptr<StepRule> rk4_rule(const System& system, double h);

}  // namespace titop::detail
