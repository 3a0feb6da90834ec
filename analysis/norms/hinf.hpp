#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <titop/graph/state_space.hpp>
#include <vector>

/// The H-infinity norm of a model, over all frequencies or over a band.
namespace titop {

/// Options of norm_hinf.
struct HinfOptions {
  /// Frequencies that count [Hz]; the second may be infinite.
  std::array<double, 2> band_hz = {0, std::numeric_limits<double>::infinity()};
};

/// The largest gain of a model, and where it is reached: H(j omega) right = value left.
struct HinfNorm {
  double value = 0;              ///< largest singular value of H over the band
  double omega = 0;              ///< [rad/s]; infinite: of the direct term
  Eigen::VectorXcd left, right;  ///< its singular vectors, of norm 1
  double second = 0;  ///< second singular value of H there; 0 for a single input or output
  /// Frequencies apart from omega at which the largest singular value is as large, up to half the
  /// digits of double, 1.5e-8; of neighbouring peaks between which it falls by less only one
  /// counts. Rounding of the poles lowers the top of a peak narrower than 1e-11 of its frequency by
  /// more than that: such a one may be missing. Where it is constant: the farther end of the band.
  std::vector<double> others;
};

/// Largest number of states of norm_hinf: 1200 eigenvalues of the Hamiltonian take half a minute.
inline constexpr int kMostStatesOfHinf = 600;

/// The H-infinity norm by level sets [Bruinsma, Steinbuch 1990; Boyd, Balakrishnan, Kabamba 1989]:
/// a singular value of H(j omega) is gamma where the Hamiltonian matrix of gamma has the eigenvalue
/// j omega; the largest singular value at the midpoints of these frequencies is the next gamma,
/// until none is larger by 1e-10. All eigenvalues count, also those off the axis, and the gain is
/// evaluated at them, too, since rounding may merge neighbours: at worst a point more is evaluated,
/// and no tolerance decides which ones are on the axis. omega is then refined to where the slope of
/// the singular value is 0. Poles right of the axis are allowed: the result is then the L-infinity
/// norm.
///
/// Throws singular if a pole lies on the axis inside of the band (the norm is infinite), bad_value
/// for an invalid band and for a model of more than kMostStatesOfHinf states, size for matrices
/// that do not fit each other, not_finite for entries that are not finite. O(200 states^3) per
/// level, of which there are 3 to 6.
///
///     const HinfNorm n = norm_hinf(system.state_space(), {.band_hz = {0, 10}});
HinfNorm norm_hinf(const StateSpace& model, const HinfOptions& options = {});

}  // namespace titop
