#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <titop/titop.hpp>
#include <vector>

#include "../../examples/by_hand/by_hand.hpp"

/// Compares a reduced system with a reference that is not titop's.
namespace titop_test {

/// Reference of a scene, by hand: transfer and poles [rad/s].
struct Truth {
  std::function<Eigen::MatrixXcd(std::complex<double>)> transfer;
  std::vector<double> omegas;
};

/// Accelerations of an undamped structure, with this number of motions without stiffness: the sum
/// over its modes.
Truth accelerations(const by_hand::Structure& a, Eigen::Index rigid);

/// Points of the band [rad/s]: so many steps, smaller towards both ends, each halved until the
/// phase of the poles changes by 0.04 at most: each contributes 2 pi over its width on the ray,
/// poles outside of the band over their distance.
std::vector<double> fine_points(const titop::Scene& scene, const std::vector<double>& poles,
                                int steps);

/// Two transfers on points of the ray.
struct Compared {
  Eigen::MatrixXd error, peak;  ///< largest |difference| and largest |exact| of each pair
  /// Zero by symmetry: its own peak is rounding.
  bool is_zero(Eigen::Index i, Eigen::Index j) const;
  /// Largest error of a pair over its own peak.
  double relative() const;
};
using TransferOf = std::function<Eigen::MatrixXcd(std::complex<double>)>;
Compared compared(const titop::Scene& scene, const std::vector<double>& points, const Truth& truth,
                  const TransferOf& other);

/// On a grid of the band independent of the bound's, at least ten times finer everywhere
/// (tests/reduction/phase_grid.cpp).
struct Beside {
  double bound = 0;  ///< largest |error| / (bound * peak): 1 or less
  double error = 0;  ///< largest |error| of a pair over its own peak on this grid
  double sharp = 0;  ///< |error| / (bound * peak) of the pair with the worst bound: the phase grid
                     ///< promises 0.877, if rounding is negligible
  double peak_low = HUGE_VAL, peak_high = 0;  ///< ErrorBound::peak over the peak on this grid, of
                                              ///< pairs that symmetry does not make 0
};
/// Use more than eighteen steps per sample of the bound if `truth` has no poles.
Beside beside(const titop::ReducedSystem& r, const titop::Scene& scene, const Truth& truth,
              int steps = 0);

}  // namespace titop_test
