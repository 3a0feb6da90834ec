#pragma once

#include <complex>
#include <string>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop {

/// One pole, or one conjugate pair (then the one with positive imaginary part).
struct Pole {
  std::complex<double> s;  ///< [rad/s]
  bool pair = false;       ///< s and conj(s)
  double omega = 0;        ///< |s| [rad/s]
  double hertz = 0;        ///< |s| / 2 pi [Hz]
  double damping = 0;      ///< -Re(s) / |s| [-]; 0 for s = 0
  /// Blocks that take part, with their share (participation factors summed over the block's
  /// states, of total 1), largest first, down to 5 %.
  std::vector<std::pair<std::string, double>> blocks;
};

/// Poles sorted by frequency. Undamped and proportionally damped models are solved as symmetric
/// problems, so that undamped poles lie exactly on the axis and slow ones have as many digits as
/// fast ones (`eigh_graded`; if a rigid motion is spread over several states, or beyond 400 pairs,
/// poles slower than 3e-7 of the fastest are returned as 0). States that A couples to no others are
/// exact poles. Other models: eigenvalues of the scaled A. O(n^3).
std::vector<Pole> poles(const StateSpace& model);

/// A table: rad/s, Hz, damping, blocks.
std::string to_string(const std::vector<Pole>& poles);

/// The second-order form of A, if it has one: x = [q; qdot] in some order, qddot = -K q - Z qdot
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
SecondOrder second_order(const Eigen::MatrixXd& A);

}  // namespace titop
