#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <titop/titop.hpp>
#include <vector>

#include "../../examples/by_hand/by_hand.hpp"

/// A reduced system beside the truth, where the truth is not titop's.
namespace titop_test {

/// What a scene is asked about, by hand: transfer and poles [rad/s].
struct Truth {
  std::function<Eigen::MatrixXcd(std::complex<double>)> transfer;
  std::vector<double> omegas;
};

/// Accelerations of an undamped structure, of which no spring holds so many motions.
inline Truth accelerations(const by_hand::Structure& a, Eigen::Index rigid) {
  Truth truth{[a](std::complex<double> s) { return by_hand::accel_transfer(a, s); }, {}};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(a.K, a.M,
                                                                        Eigen::EigenvaluesOnly);
  for (const double lambda : modes.eigenvalues().tail(a.M.rows() - rigid))
    truth.omegas.push_back(std::sqrt(lambda));
  return truth;
}

/// On a grid of the band that knows nothing of the bound's: equal steps, and points across the
/// poles.
struct Beside {
  double bound = 0;  ///< largest |error| over what the bound allows: 1 or less
  double error = 0;  ///< largest |error| of a pair over its own peak on this grid
  double peak_low = HUGE_VAL, peak_high = 0;  ///< ErrorBound::peak over the peak on this grid, of
                                              ///< pairs that symmetry does not make 0
};
inline Beside beside(const titop::ReducedSystem& r, const titop::Scene& scene, const Truth& truth,
                     int steps = 100) {
  const double low = 2 * std::numbers::pi * scene.band_hz[0];
  const double high = 2 * std::numbers::pi * scene.band_hz[1], zeta = scene.damping_floor;
  std::vector<double> omega;
  for (int i = low > 0 ? 0 : 1; i <= steps; ++i) omega.push_back(low + (high - low) * i / steps);
  for (const double pole : truth.omegas)
    for (int i = -6; i <= 6; ++i)
      if (const double w = pole * (1 + 0.4 * zeta * i); w > low && w < high) omega.push_back(w);
  const titop::ErrorBound& b = r.bound();
  Eigen::MatrixXd worst = Eigen::MatrixXd::Zero(b.peak.rows(), b.peak.cols()), peak = worst;
  for (const double w : omega) {
    const std::complex<double> s{zeta * w, std::sqrt(1 - zeta * zeta) * w};
    const Eigen::MatrixXcd H = truth.transfer(s);
    worst = worst.cwiseMax((H - r.transfer(s)).cwiseAbs());
    peak = peak.cwiseMax(H.cwiseAbs());
  }
  Beside result;
  result.bound = worst.cwiseQuotient(b.peak.cwiseProduct(b.pairs)).maxCoeff();
  for (Eigen::Index i = 0; i < peak.rows(); ++i)
    for (Eigen::Index j = 0; j < peak.cols(); ++j) {
      const double row = peak.row(i).maxCoeff(), column = peak.col(j).maxCoeff();
      if (peak(i, j) < 1e-4 * row * column / peak.maxCoeff()) continue;
      result.error = std::max(result.error, worst(i, j) / peak(i, j));
      result.peak_low = std::min(result.peak_low, b.peak(i, j) / peak(i, j));
      result.peak_high = std::max(result.peak_high, b.peak(i, j) / peak(i, j));
    }
  return result;
}

}  // namespace titop_test
