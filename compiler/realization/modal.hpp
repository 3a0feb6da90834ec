#pragma once

#include <Eigen/Core>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop {

/// The second-order form of a model whose states are coordinates and their rates (rates_of), if it
/// has one: x = [q; qdot] in some order, qddot = -K q - Z qdot with K symmetric after q = D y.
struct SecondOrder {
  bool found = false;
  std::vector<int> q, qdot;      ///< positions of the pairs among the states
  Eigen::MatrixXd D, D_inverse;  ///< diagonal, unless it is of the energy
  Eigen::MatrixXd S;             ///< symmetric positive semidefinite: yddot = -S y - Z ydot
  Eigen::MatrixXd Z;             ///< in the same coordinates
  Eigen::MatrixXd skew;  ///< antisymmetric part, removed from S; small in the modes of S, too
  double asymmetry = 0;  ///< largest |S_ij - S_ji| over sqrt(S_ii S_jj) before; up to 1e-9
};
/// D is diagonal, or, if no diagonal matrix makes K symmetric, of the model's potential energy
/// x' E x / 2, if it is given (as many rows as states): D' E D = I, as in closed chains, whose
/// coordinates share springs and masses. `found` is false if a state is neither coordinate nor
/// rate, an entry is not finite, or the asymmetry is above 1e-9 either way. Throws nothing. O(n^2);
/// O(n^3) by the energy.
SecondOrder second_order(const StateSpace& model, const Eigen::MatrixXd& energy = {});

}  // namespace titop
