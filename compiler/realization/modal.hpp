#pragma once

#include <Eigen/Core>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop {

/// The second-order form of a model whose states are coordinates and their rates (rates_of), if it
/// has one: x = [q; qdot] in some order, qddot = -K q - Z qdot
/// with K symmetric after the diagonal scaling d (q = d y).
struct SecondOrder {
  bool found = false;
  std::vector<int> q, qdot;  ///< positions of the pairs among the states
  Eigen::VectorXd d;         ///< scaling
  Eigen::MatrixXd S;         ///< symmetric positive semidefinite: yddot = -S y - Z ydot
  Eigen::MatrixXd Z;         ///< same scaling
  Eigen::MatrixXd skew;      ///< antisymmetric part, removed from S; small in the modes of S, too
  double asymmetry = 0;      ///< largest |S_ij - S_ji| over sqrt(S_ii S_jj) before; up to 1e-9
};
/// `found` is false if a state is neither coordinate nor rate, an entry is not finite, or the
/// asymmetry is above 1e-9. Throws nothing. O(n^2).
SecondOrder second_order(const StateSpace& model);

}  // namespace titop
