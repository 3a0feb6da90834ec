#pragma once

#include <vector>

#include "support/network.hpp"

/// Sparse matrices from blocks.
namespace titop_bench {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// The entries of m that are not 0, from this row and column on.
inline void add(Triplets& list, const Eigen::MatrixXd& m, int row, int col) {
  for (int j = 0; j < m.cols(); ++j)
    for (int i = 0; i < m.rows(); ++i)
      if (m(i, j) != 0) list.emplace_back(row + i, col + j, m(i, j));
}

/// Entries at one place are added.
inline Sparse sparse(const Triplets& list, int rows, int cols) {
  Sparse m(rows, cols);
  m.setFromTriplets(list.begin(), list.end());
  return m;
}

}  // namespace titop_bench
