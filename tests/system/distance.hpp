#pragma once

#include <algorithm>
#include <titop/graph/state_space.hpp>
#include <utility>

namespace titop_test {

/// Largest difference of the matrices' entries, each over the largest entry of its matrix of b.
inline double distance(const titop::StateSpace& a, const titop::StateSpace& b) {
  double worst = 0;
  for (const auto& [x, y] :
       {std::pair(&a.A, &b.A), std::pair(&a.B, &b.B), std::pair(&a.C, &b.C), std::pair(&a.D, &b.D)})
    worst = std::max(worst, (*x - *y).cwiseAbs().maxCoeff() / y->cwiseAbs().maxCoeff());
  return worst;
}

}  // namespace titop_test
