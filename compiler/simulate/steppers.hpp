#pragma once

#include <memory>
#include <titop/compiler/system.hpp>

/// One step of each method. For the compiler's own files only.
namespace titop::detail {

/// x at the end of a step from x at its beginning and the inputs at both ends.
class StepRule {
 public:
  virtual ~StepRule() = default;
  virtual Eigen::VectorXd step(const Eigen::VectorXd& x, const Eigen::VectorXd& u0,
                               const Eigen::VectorXd& u1) const = 0;
};

/// x1 = Phi x + G0 u0 + G1 (u1 - u0), from one exponential of order n + 2 m.
std::unique_ptr<StepRule> exact_rule(const System& system, double h);
/// x1 = 2 x_m - x with (2 / h - A) x_m = (2 / h) x + B (u0 + u1) / 2, by the factors at s = 2 / h.
std::unique_ptr<StepRule> midpoint_rule(const SystemData& data, double h);
std::unique_ptr<StepRule> rk4_rule(const System& system, double h);

}  // namespace titop::detail
