#pragma once

#include <Eigen/Core>
#include <titop/graph/graph.hpp>
#include <vector>

namespace titop {

/// Who drives a channel: the equations on its two signals and the directions that they take.
struct Drive {
  std::vector<int> accel, force, added;  ///< equations: `accel =`, `force =`, `force +=`
  Eigen::MatrixXd S;                     ///< rows: directions in which the acceleration is driven
  Eigen::MatrixXd N;                     ///< rows: the others; there the force is driven
};

/// The drives of all channels, by what the user wrote (not by rows of blocks). S and N together are
/// an orthonormal basis of the channel's space (the unit vectors where no direction is oblique).
/// O(equations).
std::vector<Drive> drives(const Graph& graph);

/// Orthonormal rows spanning the complement of the orthonormal rows of S (m x n).
Eigen::MatrixXd complement(const Eigen::MatrixXd& S, int n);

}  // namespace titop
