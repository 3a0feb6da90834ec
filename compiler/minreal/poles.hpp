#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <titop/graph/state_space.hpp>
#include <utility>
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
  /// states, of total 1), largest first, down to 5 %. Motions of a free body, which are states if
  /// an equation or an output reads them, stand under their name: "hub.parent.angular_rate".
  std::vector<std::pair<std::string, double>> blocks;
  /// Least and largest damping ratio of the modes, clamped at P, of the bodies among `blocks`, if
  /// `unlike_bodies`; else -1. Set by System::poles.
  double least_xi = -1, largest_xi = -1;

  /// True for an assembled mode whose damping ratio differs from those of its bodies: it is below a
  /// fifth of their least xi, if these bodies have half of the mode or more; or above five times
  /// their largest xi, if no other block takes part, no equation reads a rate and no one-way block
  /// has states (dampers, controllers).
  bool unlike_bodies() const { return largest_xi >= 0; }
};

/// "0.003", "0.003 to 0.005": of a mode that is damped unlike its bodies.
std::string xi_of_bodies(const Pole& pole);

/// Poles sorted by frequency. Undamped and proportionally damped models are solved as symmetric
/// problems, so that undamped poles lie exactly on the axis and slow ones have as many digits as
/// fast ones (`eigh_graded`; if a rigid motion is spread over several states, poles slower than
/// 3e-7 of the fastest are returned as 0, and the relative error of one that is k times slower is
/// k^2 times larger). States that A couples to no others are exact poles. Other models: poles at 0
/// by rows of A that depend on the others up to the rounding of each entry (minreal/at_zero.hpp):
/// momenta that rotors, joints and controllers conserve; the others are eigenvalues of the scaled A
/// without these. O(n^3).
///
/// `rounding`: of the entries of A, as of a dense model with cancellation; empty: 2.2e-16 of each.
/// System::poles gives that of the factors, and for a minimal model 2.2e-16 of each entry and as
/// much again for every removed state.
/// `energy`: potential energy x' E x / 2, if known; models whose coordinates share springs and
/// masses (closed chains) are solved as symmetric problems by it, if every coordinate has
/// stiffness and no state has been removed.
/// A model without names of its states is one block "x". Throws size if A is not square.
std::vector<Pole> poles(const StateSpace& model, const Eigen::MatrixXd& rounding = {},
                        const Eigen::MatrixXd& energy = {});

/// A table: rad/s, Hz, damping, blocks; behind modes that are damped unlike their bodies the xi of
/// these.
std::string to_string(const std::vector<Pole>& poles);

}  // namespace titop
