#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/compiler/economy/phase_grid.hpp>
#include <titop/compiler/economy/ray.hpp>
#include <titop/compiler/parallel.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kFar = 10;  ///< poles in s^2 that stand for all beyond twice the band

/// Poles of the whole; exact where its modes do not couple.
std::vector<Complex> poles_of(const Whole& w) {
  std::vector<Complex> result;
  for (Index j = 0; j < w.order(); ++j) {
    const double half = w.damping(j) / 2;
    const Complex root = std::sqrt(Complex(half * half - w.lambda(j), 0));
    result.push_back(-half + root);
    if (root.imag() == 0 && w.Z.size() > 0) result.push_back(-half - root);
  }
  return result;
}

/// Those that are not in the first list, to rounding: common poles count once.
std::vector<Complex> merged(std::vector<Complex> poles, const std::vector<Complex>& more) {
  const std::size_t own = poles.size();
  for (const Complex& p : more)
    if (std::none_of(poles.begin(), poles.begin() + static_cast<std::ptrdiff_t>(own),
                     [&](const Complex& q) { return std::abs(p - q) <= 1e-12 * std::abs(q); }))
      poles.push_back(p);
  return poles;
}

/// log of a typical size of every pair: row + column, by least squares over the pairs that are not
/// 0, so that units cancel.
MatrixXd typical(const MatrixXd& peak) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(peak.rows()),
                  column = Eigen::VectorXd::Zero(peak.cols());
  for (int sweep = 0; sweep < 50; ++sweep) {
    for (Index i = 0; i < peak.rows(); ++i) {
      double sum = 0, count = 0;
      for (Index j = 0; j < peak.cols(); ++j)
        if (peak(i, j) > 0) sum += std::log(peak(i, j)) - column(j), ++count;
      row(i) = count > 0 ? sum / count : 0;
    }
    for (Index j = 0; j < peak.cols(); ++j) {
      double sum = 0, count = 0;
      for (Index i = 0; i < peak.rows(); ++i)
        if (peak(i, j) > 0) sum += std::log(peak(i, j)) - row(i), ++count;
      column(j) = count > 0 ? sum / count : 0;
    }
  }
  return row.replicate(1, peak.cols()) + column.transpose().replicate(peak.rows(), 1);
}

/// Pairs far below what their row and column suggest are compared with that (Scene).
MatrixXd floored(const MatrixXd& peak) {
  if (peak.size() == 0) return peak;
  const MatrixXd size = typical(peak).array().exp();
  const MatrixXd Q = peak.cwiseQuotient(size);
  const double overall = Q.maxCoeff();
  MatrixXd result = peak;
  for (Index i = 0; i < peak.rows(); ++i)
    for (Index j = 0; j < peak.cols(); ++j) {
      const double suggested = Q.row(i).maxCoeff() * Q.col(j).maxCoeff() / overall;
      result(i, j) = std::max(peak(i, j), 1e-6 * suggested * size(i, j));
      if (!(result(i, j) > 0)) result(i, j) = 1;  // nothing at all reaches this output
    }
  return result;
}

}  // namespace

Band band_of(const Scene& scene, const Whole& w) {
  const double low = 2 * std::numbers::pi * scene.band_hz[0],
               high = 2 * std::numbers::pi * scene.band_hz[1];
  if (high > 0) return {std::max(low, 1e-4 * high), high};
  const double first = w.elastic() > 0 ? std::sqrt(w.lambda(0)) : 1;  // static gain only
  return {1e-6 * first, 1e-6 * first};
}

Complex on_ray(const Scene& scene, double omega) {
  const double zeta = scene.damping_floor;
  return {zeta * omega, std::sqrt(1 - zeta * zeta) * omega};
}

std::vector<double> sample_points(const Scene& scene, const Band& band, const Whole& w,
                                  const std::vector<Complex>& small, double step) {
  if (!(band.high > band.low)) return {band.low};
  const bool all = scene.bound == BoundKind::theorem;
  // Undamped and without rates everything is rational in s^2: half the poles.
  const bool squared = w.Z.size() == 0 && w.cv.isZero(0);
  const Complex turn = std::conj(on_ray(scene, 1));
  PhaseBand grid{band.low, band.high, {}, all ? 0 : squared ? kFar : 2 * kFar};
  if (squared) grid.low *= grid.low, grid.high *= grid.high;
  for (const Complex& p : merged(poles_of(w), small)) {
    if (!all && std::abs(p) > 2 * band.high) continue;
    for (const Complex& s : {p, std::conj(p)}) {
      const Complex x = s * turn;
      grid.poles.push_back(squared ? x * x : x);
      if (squared || s.imag() == 0) break;
    }
  }
  std::vector<double> points = phase_grid(grid, step);
  if (squared)
    for (double& x : points) x = std::sqrt(x);
  return points;
}

Samples sample(const System& system, const Scene& scene, std::vector<double> omega) {
  Samples result;
  result.omega = std::move(omega);
  result.H.resize(result.omega.size());
  for (const double w : result.omega) result.s.push_back(on_ray(scene, w));
  parallel(result.s.size(), 0,
           [&] { return [&](std::size_t i) { result.H[i] = system.transfer(result.s[i]); }; });
  result.peak = MatrixXd::Zero(static_cast<Index>(system.outputs().size()),
                               static_cast<Index>(system.inputs().size()));
  for (const auto& H : result.H) result.peak = result.peak.cwiseMax(H.cwiseAbs());
  result.peak = floored(result.peak);
  return result;
}

}  // namespace titop::detail
