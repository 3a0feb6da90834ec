#pragma once

#include <titop/compiler/minreal/staircase.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Poles of a model with their vectors, and the clusters of poles without separate vectors. For the
/// compiler's own files.
namespace titop::minreal {

inline constexpr double kIll = 1e6;  ///< condition number of a pole that is judged by its vector

struct PoleClusters {
  /// For a cluster, V and W have a basis of its invariant subspaces (linalg/spectral.hpp).
  linalg::Eigensystem e;
  Eigen::MatrixXcd T;  ///< block diagonal, upper triangular
  /// Clusters that are judged as a whole: multiple poles, ill-conditioned ones, and those so near
  /// to 0 that rounding of A has turned their vectors by more than kWarn. Places in `e`, ascending.
  std::vector<std::vector<Eigen::Index>> clusters;
  std::vector<std::vector<int>> components;  ///< states that share no entry of A with others
  std::vector<int> component;                ///< of each pole
  std::vector<double> size;                  ///< norm of the scaled A of each component
};

/// O(25 n^3). Throws as linalg::schur.
PoleClusters pole_clusters(const Eigen::MatrixXd& A);

/// A cluster as a separate model: A V = V A_own, with W V = 1.
struct OwnModel {
  ClusterModel model;
  Eigen::MatrixXd V, W;  ///< n x k, k x n
};
/// Rounding: first-order effect of errors of the size of a Schur form's, the largest of four
/// samples. O(n^2 k) each.
OwnModel own_model(const PoleClusters& p, const std::vector<Eigen::Index>& cluster,
                   const StateSpace& model);

}  // namespace titop::minreal
