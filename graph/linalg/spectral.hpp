#pragma once

#include <Eigen/Core>
#include <vector>

/// Poles in clusters: a real matrix as a block diagonal one, by a transformation of bounded size.
namespace titop::linalg {

/// A V = V T, W = V^-1, T block diagonal with upper triangular blocks (all n x n); a cluster's part
/// of V is its invariant subspace, of W that of A'.
struct Spectrum {
  Eigen::VectorXcd values;  ///< diagonal of T; of a pair the upper half plane's first
  Eigen::MatrixXcd V, W, T;
  struct Cluster {
    Eigen::Index first = 0, count = 0;
    /// One real pole, or one pair with its two vectors, conjugate. Else V has a basis of the
    /// cluster's invariant subspace, and no vector of a single pole.
    bool simple = false;
  };
  std::vector<Cluster> clusters;  ///< each closed under conjugation
};

/// Splits a real square matrix [Bavely, Stewart 1979]: a cluster takes in the nearest pole while
/// the Sylvester equation that separates it from the rest has a solution of Frobenius norm above
/// `bound`, or while that pole is no further away than 100 roundings of |A|: a Jordan block is
/// never split, and a multiple pole is one cluster. A pair whose two vectors are parallel up to 1 /
/// bound, or whose poles are one number, is not simple. `A` should be scaled
/// (linalg/similarity_scaling.hpp): norms are those of A's own units. Throws as `schur`. O(25 n^3),
/// and O(n^2) for each pole that a cluster takes in.
Spectrum spectrum(const Eigen::MatrixXd& A, double bound);

}  // namespace titop::linalg
