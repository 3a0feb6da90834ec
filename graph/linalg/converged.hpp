#pragma once

#include <algorithm>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <vector>

namespace titop::linalg {

/// A solver by the QR iteration (EigenSolver, RealSchur), of A with its rows and columns in
/// `order`: row i of its vectors belongs to row order[i] of A.
template <class Solver>
struct Ordered {
  Solver solver;
  std::vector<Eigen::Index> order;
};

/// In the order of A's parts (linalg/similarity_scaling.hpp) A is block upper triangular, and
/// reduction to Hessenberg form and iteration keep each zero below its blocks: the eigenvalues of a
/// part have no rounding of the entries between parts. Exceptions: entries below eps^2 of A's norm,
/// which count as 0, and an exceptional shift, after 10 and 30 steps. (LAPACK's gebal does so for
/// parts of one state.)
///
/// Eigen's iteration can cycle on defective matrices whose shifts and rotations repeat, since it
/// tries other shifts after 10 and 30 steps only. Rows and columns in another order, which causes
/// no rounding, avoid that: by parts, backwards, and each rotated by one, n + 1 orders at most.
/// `solver.info()` tells if none has converged. O(25 n^3) for each order.
template <class Solver>
Ordered<Solver> converged(const Eigen::MatrixXd& A, bool vectors) {
  std::vector<Eigen::Index> order;
  for (const std::vector<int>& part : parts(A)) order.insert(order.end(), part.begin(), part.end());
  Solver solver(Eigen::MatrixXd(A(order, order)), vectors);
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
