#include <fmt/format.h>

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

constexpr double kNothing = 1e-10;  ///< of what its row and column have: a pair of rounding only
constexpr int kFar = 10;            ///< poles in s^2 that stand for all beyond twice the band

/// Poles of the whole; where its modes couple and `couple` was not called: without that.
std::vector<Complex> poles_of(const Whole& w) {
  if (!w.poles.empty()) return w.poles;
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

/// What every pair would be at s if output and input saw all modes alike: norms of what the output
/// reads and the input drives, each mode weighed by its response [Cauchy, Schwarz]. Units cancel
/// against the pair's own.
MatrixXd alike(const Whole& w, Complex s) {
  MatrixXd out = MatrixXd::Zero(w.ca.rows(), 1), in = MatrixXd::Zero(1, w.b.cols());
  for (Index j = 0; j < w.order(); ++j) {
    if (w.lambda(j) == 0 && s == 0.0) continue;
    const double weight = 1 / std::abs(s * (s + w.damping(j)) + w.lambda(j));
    for (Index i = 0; i < out.size(); ++i)
      out(i) += weight * std::norm(s * (s * w.ca(i, j) + w.cv(i, j)) + w.cq(i, j));
    // What symmetry silences: as it was read of the motions that have gone, with its static part.
    for (Index i = 0; i < out.size(); ++i)
      out(i) += weight * w.lambda(j) * std::norm(w.silent(i, 0) + s * w.silent(i, 1));
    for (Index m = 0; m < in.size(); ++m) in(m) += weight * w.b(j, m) * w.b(j, m);
  }
  return out.cwiseSqrt() * in.cwiseSqrt();
}

/// A band from 0 has no place for outputs that grow without end there.
void refuse_integrals(const System& system, const Whole& w) {
  for (Index j = w.elastic(); j < w.order(); ++j) {
    Index m = 0;
    if (w.b.row(j).cwiseAbs().maxCoeff(&m) == 0) continue;
    for (Index i = 0; i < w.ca.rows(); ++i)
      if (w.cq(i, j) != 0 || w.cv(i, j) != 0)
        throw Error(Code::bad_value,
                    fmt::format("{} reads the {} of a motion without stiffness that {} drives: it "
                                "has no gain at 0 Hz, where the scene's band starts",
                                system.outputs()[static_cast<std::size_t>(i)],
                                w.cq(i, j) != 0 ? "position" : "rate",
                                system.inputs()[static_cast<std::size_t>(m)]),
                    "start Scene::band_hz above 0, read an acceleration instead, or leave this "
                    "output out");
  }
}

/// At 0 also where blocks integrate what the system does not.
Eigen::MatrixXcd transfer(const System& system, Complex s) {
  return s == 0.0 ? system.static_gain().cast<Complex>() : system.transfer(s);
}

}  // namespace

Band band_of(const System& system, const Scene& scene, const Whole& w) {
  Band band{2 * std::numbers::pi * scene.band_hz[0], 2 * std::numbers::pi * scene.band_hz[1], 0};
  if (band.low > 0 || w.loose == 0) return band;
  refuse_integrals(system, w);
  double first = band.high > 0 ? band.high : 1;
  for (const Complex& p : poles_of(w))
    if (p != 0.0 && std::abs(p) < first) first = std::abs(p);
  band.start = 1e-6 * first;
  return band;
}

Complex on_ray(const Scene& scene, double omega) {
  const double zeta = scene.damping_floor;
  return {zeta * omega, std::sqrt(1 - zeta * zeta) * omega};
}

std::vector<double> sample_points(const Scene& scene, const Band& band, const Whole& w,
                                  const std::vector<Complex>& small, double step) {
  if (!(band.high > band.low)) return {std::max(band.low, band.start)};
  const bool all = scene.bound == BoundKind::theorem;
  // Undamped and without rates everything is rational in s^2: half the poles.
  const bool squared = w.Z.size() == 0 && w.cv.isZero(0);
  const Complex turn = std::conj(on_ray(scene, 1));
  const int far = all ? static_cast<int>(w.far) : kFar;
  PhaseBand grid{band.low, band.high, {}, squared ? far : 2 * far};
  if (squared) grid.low *= grid.low, grid.high *= grid.high;
  for (const Complex& p : merged(poles_of(w), small)) {
    if (p == 0.0) continue;  // motions without stiffness are in both models: no pole of the error
    if (!all && std::abs(p) > 2 * band.high) continue;
    for (const Complex& s : {p, std::conj(p)}) {
      const Complex x = s * turn;
      grid.poles.push_back(squared ? x * x : x);
      if (squared || s.imag() == 0) break;
    }
  }
  std::vector<double> points = phase_grid(grid, step);
  for (double& x : points) x = std::max(squared ? std::sqrt(x) : x, band.start);
  return points;
}

Samples sample(const System& system, const Scene& scene, const Whole& w,
               std::vector<double> omega) {
  Samples result;
  result.omega = std::move(omega);
  result.H.resize(result.omega.size());
  for (const double omega_k : result.omega) result.s.push_back(on_ray(scene, omega_k));
  parallel(result.s.size(), 0,
           [&] { return [&](std::size_t i) { result.H[i] = transfer(system, result.s[i]); }; });
  result.peak = MatrixXd::Zero(w.ca.rows(), w.b.cols());
  for (std::size_t k = 0; k < result.s.size(); ++k) {
    result.peak = result.peak.cwiseMax(result.H[k].cwiseAbs());
    result.peak = result.peak.cwiseMax(1e-6 * alike(w, result.s[k]));
  }
  // Where no mode is left to say what a pair might be (rigid bodies only): its row and column.
  const Eigen::VectorXd row = result.peak.rowwise().maxCoeff().cwiseSqrt();
  const Eigen::RowVectorXd column = result.peak.colwise().maxCoeff().cwiseSqrt();
  result.peak = result.peak.cwiseMax(kNothing * row * column);
  result.peak = (result.peak.array() > 0).select(result.peak, 1);  // nothing gets there
  return result;
}

MatrixXd rounding(const Whole& w, const Samples& samples) {
  MatrixXd size = MatrixXd::Zero(w.ca.rows(), w.b.cols());
  for (const Complex& s : samples.s) size = size.cwiseMax(alike(w, s));
  return (5e-14 * size.cwiseQuotient(samples.peak)).array() + 1e-12;
}

}  // namespace titop::detail
