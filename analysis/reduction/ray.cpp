#include <algorithm>
#include <cmath>
#include <limits>
#include <titop/analysis/reduction/phase_grid.hpp>
#include <titop/analysis/reduction/ray.hpp>
#include <titop/compiler/system/zero_pairs.hpp>
#include <titop/graph/paths.hpp>
#include <titop/graph/support/parallel.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kNoPair = 1e-10;       ///< of its row and column: a pair at rounding level
constexpr double kOfCancelled = 5e-14;  ///< of terms that cancel: some 200 units of the last place
constexpr double kPoleUnits = 2;        ///< units of the last place of a pole
constexpr int kFar = 10;                ///< poles in s^2 in place of all beyond twice the band
constexpr double kOnePole = 1e-12;      ///< relative distance of poles that are one

bool equal(Complex p, Complex q) { return std::abs(p - q) <= kOnePole * std::abs(q); }

/// True if this pole equals the last two. Modes of one frequency and one damping, however many, are
/// one simple pole of the transfer; the second one accounts for their difference within the
/// tolerance of equality.
bool counted(const std::vector<Complex>& poles, Complex p) {
  const std::size_t n = poles.size();
  return n >= 2 && equal(p, poles[n - 1]) && equal(p, poles[n - 2]);
}

/// Poles of the whole; if its modes couple and `couple` was not called: without that.
std::vector<Complex> poles_of(const Whole& w) {
  if (!w.poles.empty()) return w.poles;
  std::vector<Complex> result;
  for (Index j = 0; j < w.order(); ++j) {
    const double half = w.damping(j) / 2;
    const Complex root = std::sqrt(Complex(half * half - w.lambda(j), 0));
    if (w.proportional && root.imag() > 0 && counted(result, -half + root)) continue;
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
                     [&](const Complex& q) { return equal(p, q); }))
      poles.push_back(p);
  return poles;
}

/// Sensitivity of outputs to the modes: a q'' + v q' + q q.
struct OutputSensitivity {
  MatrixXd a, v, q;
};

/// Sensitivities with positions as such, not as static gain and accelerations: for a mode far below
/// the band each of these is as large as its static part, and they cancel.
OutputSensitivity as_meant(const Whole& w) {
  OutputSensitivity r{w.ca, w.cv, w.cq};
  const Index n = w.elastic();
  for (Index i = 0; i < r.a.rows(); ++i) {
    if (!w.is_position[static_cast<std::size_t>(i)]) continue;
    if (w.Z.size() > 0) r.v.row(i) -= w.ca.row(i) * w.Z;
    r.q.row(i).head(n) -= w.ca.row(i).head(n).cwiseProduct(w.lambda.head(n).transpose());
    r.a.row(i).setZero();
  }
  return r;
}

/// Size of every pair at s if input and output were coupled equally to all modes: norms of the
/// output's and the input's modal vectors, each mode weighted by its response [Cauchy, Schwarz].
/// Has the pair's own unit.
MatrixXd alike(const Whole& w, const OutputSensitivity& r, Complex s) {
  MatrixXd out = MatrixXd::Zero(r.a.rows(), 1), in = MatrixXd::Zero(1, w.b.cols());
  for (Index j = 0; j < w.order(); ++j) {
    if (w.lambda(j) == 0 && s == 0.0) continue;
    const double weight = 1 / std::abs(s * (s + w.damping(j)) + w.lambda(j));
    for (Index i = 0; i < out.size(); ++i)
      out(i) += weight * std::norm(s * (s * r.a(i, j) + r.v(i, j)) + r.q(i, j));
    // Outputs silenced by symmetry: their sensitivity to the removed motions, with the static part.
    for (Index i = 0; i < out.size(); ++i)
      out(i) += weight * w.lambda(j) * std::norm(w.silent(i, 0) + s * w.silent(i, 1));
    for (Index m = 0; m < in.size(); ++m) in(m) += weight * w.b(j, m) * w.b(j, m);
  }
  return out.cwiseSqrt() * in.cwiseSqrt();
}

/// Sum of the magnitudes of the modes' terms in every pair at s, outputs as they are written.
MatrixXd terms(const Whole& w, const MatrixXd& driven, Complex s) {
  MatrixXd read(w.ca.rows(), w.order());
  for (Index j = 0; j < w.order(); ++j) {
    const bool rests = w.lambda(j) == 0 && s == 0.0;
    const double weight = rests ? 0 : 1 / std::abs(s * (s + w.damping(j)) + w.lambda(j));
    for (Index i = 0; i < read.rows(); ++i)
      read(i, j) = weight * std::abs(s * (s * w.ca(i, j) + w.cv(i, j)) + w.cq(i, j));
  }
  return read * driven;
}

/// At 0 also with block integrators that have no effect in the system.
Eigen::MatrixXcd transfer(const System& system, Complex s) {
  return s == 0.0 ? system.static_gain().cast<Complex>() : system.transfer(s);
}

}  // namespace

Complex on_ray(const Scene& scene, double omega) {
  const double zeta = scene.damping_floor;
  return {zeta * omega, std::sqrt(1 - zeta * zeta) * omega};
}

SampledSpectrum::SampledSpectrum(const Whole& w)
    : poles(poles_of(w)),
      far(static_cast<int>(w.far)),
      squared(w.Z.size() == 0 && w.cv.isZero(0)),
      sizes([&w, reading = as_meant(w), driven = MatrixXd(w.b.cwiseAbs())](Complex s) {
        return PairSizes{alike(w, reading, s), terms(w, driven, s)};
      }) {}

SampledSpectrum::SampledSpectrum(const StateSpace& model, const Split& split)
    : poles(split.poles),
      by_peaks(true),
      sizes([&](Complex s) {
        const MatrixXd size = detail::terms(model, split, s);
        return PairSizes{size, size};
      }),
      paths(titop::paths(model)) {}

std::vector<double> sample_points(const Scene& scene, const Band& band, const SampledSpectrum& w,
                                  const std::vector<Complex>& small, double step) {
  if (!(band.high > band.low)) return {std::max(band.low, band.start)};
  const bool all = scene.bound == BoundKind::theorem;
  const Complex turn = std::conj(on_ray(scene, 1));
  const int far = all ? w.far : kFar;
  // Undamped and without rates everything is rational in s^2: half the poles.
  PhaseBand grid{band.low, band.high, {}, w.squared ? far : 2 * far};
  if (w.squared) grid.low *= grid.low, grid.high *= grid.high;
  for (const Complex& p : merged(w.poles, small)) {
    if (p == 0.0) continue;  // motions without stiffness are in both models: no pole of the error
    if (!all && std::abs(p) > 2 * band.high) continue;
    for (const Complex& s : {p, std::conj(p)}) {
      const Complex x = s * turn;
      grid.poles.push_back(w.squared ? x * x : x);
      if (w.squared || s.imag() == 0) break;
    }
  }
  std::vector<double> points = phase_grid(grid, step);
  for (double& x : points) x = std::max(w.squared ? std::sqrt(x) : x, band.start);
  return points;
}

std::pair<Eigen::VectorXd, Eigen::RowVectorXd> port_sizes(const MatrixXd& peak) {
  Eigen::VectorXd out = Eigen::VectorXd::Ones(peak.rows());
  Eigen::RowVectorXd in = Eigen::RowVectorXd::Ones(peak.cols());
  const auto root = [](const auto& largest) {
    return (largest.array() > 0).select(largest.array().sqrt(), 1).matrix().eval();
  };
  for (int sweep = 0; sweep < 60; ++sweep) {
    const MatrixXd left = out.cwiseInverse().asDiagonal() * peak * in.cwiseInverse().asDiagonal();
    const Eigen::VectorXd rows = left.rowwise().maxCoeff();
    const Eigen::RowVectorXd columns = left.colwise().maxCoeff();
    out = out.cwiseProduct(root(rows));
    in = in.cwiseProduct(root(columns));
  }
  return {out, in};
}

MatrixXd with_floor(MatrixXd peak, double share) {
  const auto [out, in] = port_sizes(peak);
  const Eigen::VectorXd row = (peak.rowwise().maxCoeff().array() > 0).cast<double>();
  const Eigen::RowVectorXd column = (peak.colwise().maxCoeff().array() > 0).cast<double>();
  peak = peak.cwiseMax(share * out.cwiseProduct(row) * in.cwiseProduct(column));
  return (peak.array() > 0).select(peak, 1);
}

Samples sample(const System& system, const Scene& scene, const SampledSpectrum& w,
               std::vector<double> omega) {
  Samples result;
  result.omega = std::move(omega);
  result.H.resize(result.omega.size());
  for (const double omega_k : result.omega) result.s.push_back(on_ray(scene, omega_k));
  parallel(result.s.size(), 0,
           [&] { return [&](std::size_t i) { result.H[i] = transfer(system, result.s[i]); }; });
  if (w.paths.size() > 0)
    for (Eigen::MatrixXcd& H : result.H) H = H.cwiseProduct(w.paths.cast<Complex>()).eval();
  const auto outputs = static_cast<Index>(system.outputs().size()),
             inputs = static_cast<Index>(system.inputs().size());
  MatrixXd meant = MatrixXd::Zero(outputs, inputs);
  result.peak = result.alike = meant;
  for (std::size_t k = 0; k < result.s.size(); ++k) {
    const PairSizes here = w.sizes(result.s[k]);
    result.peak = result.peak.cwiseMax(result.H[k].cwiseAbs());
    meant = meant.cwiseMax(here.alike);
    result.alike = result.alike.cwiseMax(here.terms);
  }
  const ZeroPairs zero(data_of(system), result.H);
  result.peak = zero.cleared(result.peak);
  meant = zero.of_ports(meant);
  if (w.by_peaks) {
    const auto [out, in] = port_sizes(result.peak.cwiseMax(kNearlyZero * meant));
    meant = meant.cwiseMax(out * in);
  }
  result.alike = result.alike.cwiseMax(meant);
  // Without modes to estimate a pair's size (rigid bodies only): from its row and column.
  result.peak = with_floor(result.peak.cwiseMax(kNearlyZero * meant), kNoPair);
  return result;
}

double nearest_pole(const Scene& scene, const Band& band, const SampledSpectrum& w) {
  const Complex turn = std::conj(on_ray(scene, 1));
  const double low = std::max(band.low, band.start), high = std::max(low, band.high);
  double nearest = 1;
  for (const Complex& p : w.poles) {
    const Complex x = p * turn;
    if (p != 0.0)
      nearest = std::min(nearest, std::abs(x - std::clamp(x.real(), low, high)) / std::abs(x));
  }
  return nearest;
}

MatrixXd rounding(const Samples& samples, double nearest) {
  const double resonance = kPoleUnits * std::numeric_limits<double>::epsilon() / nearest;
  return (kOfCancelled * samples.alike.cwiseQuotient(samples.peak)).array() + kOfTransfer +
         resonance;
}

}  // namespace titop::detail
