#pragma once

#include <algorithm>

#include "../scenes/by_hand.hpp"

namespace loops_test {

using namespace scenes_test;

/// The worst block of rows x cols scalars: its largest difference over all points s, over its
/// largest entry over all of them. Blocks below `weak` of the largest block, or of `unit`, are
/// compared with that limit: they contain rounding of the others.
inline double block_error(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& exact,
                          Index rows, Index cols, double weak, double unit = 0) {
  double largest = unit, worst = 0;
  for (const MatrixXcd& e : exact) largest = std::max(largest, e.cwiseAbs().maxCoeff());
  for (const MatrixXcd& x : a)
    if (!x.allFinite()) return 1e300;
  for (Index i = 0; i < exact[0].rows(); i += rows)
    for (Index j = 0; j < exact[0].cols(); j += cols) {
      double size = weak * largest, error = 0;
      for (std::size_t k = 0; k < exact.size(); ++k) {
        const auto block = exact[k].block(i, j, rows, cols);
        size = std::max(size, block.cwiseAbs().maxCoeff());
        error = std::max(error, (a[k].block(i, j, rows, cols) - block).cwiseAbs().maxCoeff());
      }
      if (error > 0) worst = std::max(worst, size > 0 ? error / size : 1.0);
    }
  return worst;
}

}  // namespace loops_test
