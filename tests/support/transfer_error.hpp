#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace titop_test {

/// "To 1e-x": the largest difference of a block over all the points, over the block's largest entry
/// over all the points. Blocks that are zero by nature (below 1e-13 of it) are compared with the
/// geometric mean of their row's and column's largest blocks; a row or a column that is zero by
/// nature (below 1e-12 of all, or of 1) has the size of the largest. The worst block counts.
template <class Matrix>
double transfer_error(const std::vector<Matrix>& a, const std::vector<Matrix>& exact,
                      const std::vector<Eigen::Index>& row_blocks,
                      const std::vector<Eigen::Index>& col_blocks) {
  const auto rows = static_cast<Eigen::Index>(row_blocks.size());
  const auto cols = static_cast<Eigen::Index>(col_blocks.size());
  Eigen::MatrixXd size = Eigen::MatrixXd::Zero(rows, cols), error = size;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    if (!a[k].allFinite()) return 1e300;
    for (Eigen::Index i = 0, r = 0; i < rows; r += row_blocks[static_cast<std::size_t>(i++)])
      for (Eigen::Index j = 0, c = 0; j < cols; c += col_blocks[static_cast<std::size_t>(j++)]) {
        const auto h = row_blocks[static_cast<std::size_t>(i)];
        const auto w = col_blocks[static_cast<std::size_t>(j)];
        const auto block = exact[k].block(r, c, h, w);
        size(i, j) = std::max(size(i, j), static_cast<double>(block.cwiseAbs().maxCoeff()));
        error(i, j) =
            std::max(error(i, j),
                     static_cast<double>((a[k].block(r, c, h, w) - block).cwiseAbs().maxCoeff()));
      }
  }
  double worst = 0;
  const double all = size.size() ? std::max(size.maxCoeff(), 1.0) : 0;
  const auto or_all = [&](double largest) { return largest > 1e-12 * all ? largest : all; };
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < cols; ++j) {
      const double mean =
          std::sqrt(or_all(size.row(i).maxCoeff()) * or_all(size.col(j).maxCoeff()));
      const double scale = size(i, j) > 1e-13 * mean ? size(i, j) : mean;
      if (error(i, j) > 0) worst = std::max(worst, scale > 0 ? error(i, j) / scale : 1.0);
    }
  return worst;
}

}  // namespace titop_test
