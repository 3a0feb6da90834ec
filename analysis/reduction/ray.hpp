#pragma once

#include <functional>
#include <titop/analysis/reduction/scene.hpp>
#include <titop/analysis/reduction/sequence.hpp>
#include <titop/analysis/reduction/split.hpp>
#include <utility>

/// Sampling on the ray of a scene. For the library's own files only.
namespace titop::detail {

/// Of the size that a pair of an input and an output has without symmetry: a smaller pair is 0.
inline constexpr double kNearlyZero = 1e-6;
/// Accuracy of the transfers that errors are measured against: kEnough of compiler/solve.
inline constexpr double kOfTransfer = 1e-12;

/// Of the lowest frequency of a model above 0: Band::start.
inline constexpr double kStart = 1e-6;

/// Ends of the band [rad/s] of the scene. A model with motions without stiffness cannot be
/// evaluated at 0: samples below `start` are taken at `start`, 1e-6 of the lowest frequency above
/// 0, where errors equal those at 0 to six digits (both models contain these motions).
struct Band {
  double low = 0, high = 0, start = 0;
};
/// Band::start of a model with these poles: 1e-6 of the slowest that is not 0, or of the band's end
/// if that is lower [rad/s].
double start_of(const std::vector<std::complex<double>>& poles, double high);
/// Throws bad_value for a band from 0 if an output reads the position or the rate of a motion
/// without stiffness that an input drives: there is no gain at 0.
Band band_of(const System& system, const Scene& scene, const Whole& whole);

/// The same of a model by states, with these poles and `integrals`, the part of those at 0.
Band band_of(const System& system, const Scene& scene,
             const std::vector<std::complex<double>>& poles, const SpectralPart& integrals);

/// Sizes of a model's pairs at one s without cancellation: outputs x inputs.
struct PairSizes {
  Eigen::MatrixXd alike;  ///< every pair if output and input were coupled equally to all modes
  Eigen::MatrixXd terms;  ///< sum of the magnitudes of the model's terms: scale of its rounding
};

/// Data of a model that sampling needs.
struct SampledSpectrum {
  std::vector<std::complex<double>> poles;  ///< [rad/s], those of pairs with Im >= 0
  int far = 0;                              ///< more poles in s^2, far above
  bool squared = false;                     ///< the transfer is rational in s^2
  bool by_peaks = false;                    ///< pairs that are 0 are compared with others, too
  std::function<PairSizes(std::complex<double>)> sizes;
  Eigen::MatrixXd paths =
      {};  ///< 0: the minimal model has no path, the pair is 0; empty: not known

  SampledSpectrum(const Whole& whole);  // NOLINT: a whole is one; it must live as long
  SampledSpectrum(const StateSpace& model, const Split& split);  ///< likewise
};

/// Points of the band for the difference of two models with these poles [rad/s, of positive
/// imaginary part for pairs], by the scene's kind of bound: phase steps of at most `step`.
std::vector<double> sample_points(const Scene& scene, const Band& band,
                                  const SampledSpectrum& whole,
                                  const std::vector<std::complex<double>>& small, double step);

/// The factored system there, on all cores. O(points * bodies).
Samples sample(const System& system, const Scene& scene, const SampledSpectrum& whole,
               std::vector<double> omega);

/// Smallest distance of a pole from the band on the ray, over its modulus; 1 at most. On an
/// undamped resonance it is the damping floor.
double nearest_pole(const Scene& scene, const Band& band, const SampledSpectrum& whole);

/// Bound of rounding in the error of each pair there, relative to its peak: 1e-12 of the transfer
/// itself (System::transfer), some units of the terms before cancellation, and the last digit
/// amplified by a pole this near.
Eigen::MatrixXd rounding(const Samples& samples, double nearest);

/// Sizes of outputs and of inputs with |H(i, j)| <= out(i) in(j), near to that for some pair of
/// every row and every column: found by scaling rows and columns by the roots of their largest
/// entries in turn, so that units cancel. Rows and columns of 0 have size 1.
std::pair<Eigen::VectorXd, Eigen::RowVectorXd> port_sizes(const Eigen::MatrixXd& peak);

/// The peaks, those of pairs that are nearly 0 raised to this share of their output's size times
/// their input's (port_sizes). Pairs of an output or an input without any peak have 1.
Eigen::MatrixXd with_floor(Eigen::MatrixXd peak, double share);

/// Throws bad_value for a band from 0 if a pair's peak is its first sample and grows towards 0 like
/// a pole there: an integral that rounding or a law spreads over several states. One transfer.
void refuse_growing(const System& system, const Scene& scene, const Band& band,
                    const Samples& samples);

/// (zeta + j sqrt(1 - zeta^2)) omega.
std::complex<double> on_ray(const Scene& scene, double omega);

}  // namespace titop::detail
