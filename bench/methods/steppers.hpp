#pragma once

#include <functional>
#include <titop/graph/state_space.hpp>

/// Time steps that the library does not offer, on the dense model: free motion only.
namespace titop_bench {

using Step = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// Average acceleration (beta = 1/4, gamma = 1/2): for a linear model the trapezoidal rule. One LU.
Step newmark(const titop::StateSpace& model, double h);
/// x + h A x: grows at any step if nothing damps.
Step explicit_euler(const titop::StateSpace& model, double h);
/// Runge-Kutta as in the library, but at any step.
Step runge_kutta(const titop::StateSpace& model, double h);

}  // namespace titop_bench
