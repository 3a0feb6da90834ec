#pragma once

#include <algorithm>
#include <titop/graph/linalg/eigen.hpp>
#include <vector>

namespace titop::linalg {

/// A solver by the QR iteration (EigenSolver, RealSchur), of A with its rows and columns in
/// `order`: row i of its vectors belongs to row order[i] of A.
template <class Solver>
struct Ordered {
  Solver solver;
  std::vector<Eigen::Index> order;
};

/// Eigen's iteration can cycle on defective matrices whose shifts and rotations repeat (two equal 2
/// x 2 systems in series), since it tries other shifts after 10 and 30 steps only. Rows and columns
/// in another order, which causes no rounding, avoid that: as they are, backwards, and each rotated
/// by one, n + 1 orders at most. `solver.info()` tells if none has converged. O(25 n^3) for each
/// order.
template <class Solver>
Ordered<Solver> converged(const Eigen::MatrixXd& A, bool vectors) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(A.rows()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
  Solver solver(A, vectors);
  for (std::size_t k = 0; k < order.size() && solver.info() == Eigen::NoConvergence; ++k) {
    if (k == 0)
      std::reverse(order.begin(), order.end());
    else
      std::rotate(order.begin(), order.begin() + 1, order.end());
    solver.compute(Eigen::MatrixXd(A(order, order)), vectors);
  }
  return {std::move(solver), std::move(order)};
}

}  // namespace titop::linalg
