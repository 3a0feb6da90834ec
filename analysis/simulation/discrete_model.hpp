#pragma once

#include <titop/graph/state_space.hpp>

namespace titop {

/// A model at equal steps: x(k + 1) = A x(k) + B u(k), y(k) = C x(k) + D u(k); `discretize`
/// (analysis/control/discrete.hpp) makes it from a continuous one.
struct DiscreteModel {
  StateSpace model;   ///< has the continuous model's states only with a zero-order hold
  double period = 0;  ///< [s]

  /// C (z - A)^-1 B + D at z = exp(j omega period). Throws singular if that is a pole. O(n^3).
  Eigen::MatrixXcd at(double omega) const;
};

}  // namespace titop
