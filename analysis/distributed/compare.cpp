#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <titop/analysis/distributed/compare.hpp>
#include <titop/analysis/reduction/bound.hpp>
#include <titop/analysis/reduction/phase_grid.hpp>
#include <titop/compiler/system/zero_pairs.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/support/parallel.hpp>

namespace titop {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr int kFar = 10;  ///< pairs of poles in place of all beyond twice the band

/// The scene's band, for a finite model with these poles.
detail::Band band_of(const Scene& scene, const std::vector<Complex>& poles) {
  const double low = 2 * std::numbers::pi * scene.band_hz[0],
               high = 2 * std::numbers::pi * scene.band_hz[1];
  return {low, high, low > 0 ? 0 : detail::start_of(poles, high)};
}

/// Frequencies of the band at which two models with poles like these can differ most.
std::vector<double> points(const Scene& scene, const detail::Band& band,
                           const std::vector<Complex>& poles) {
  if (!(band.high > band.low)) return {std::max(band.low, band.start)};
  const Complex turn = std::conj(detail::on_ray(scene, 1));
  detail::PhaseBand grid{band.low, band.high, {}, 2 * kFar};
  for (const Complex& p : poles)
    if (p != 0.0 && std::abs(p) <= 2 * band.high) grid.poles.insert(grid.poles.end(), 2, p * turn);
  std::vector<double> omega = detail::phase_grid(grid, detail::kPhase);
  for (double& x : omega) x = std::max(x, band.start);
  return omega;
}

void require_same(const std::vector<std::string>& finite, const std::vector<std::string>& exact,
                  const char* subject) {
  if (finite != exact)
    throw Error(Code::bad_value,
                fmt::format("the finite model has {} {}, the exact one {}, or others",
                            finite.size(), subject, exact.size()),
                "compare models of the same scene, with the same inputs and outputs");
}

void require_some(const std::vector<std::string>& names, const char* subject) {
  if (names.empty())
    throw Error(Code::bad_value, fmt::format("the models have no {}", subject),
                "declare an input and an output in both diagrams");
}

using TransferAt = std::function<MatrixXcd(Complex)>;

/// Fills H and peak, and returns the differences there.
std::vector<MatrixXcd> differences(const TransferAt& finite, const System& exact,
                                   detail::Samples& samples) {
  const std::size_t count = samples.omega.size();
  samples.H.resize(count);
  std::vector<MatrixXcd> E(count);
  detail::parallel(count, 0, [&] {
    return [&](std::size_t k) {
      samples.H[k] = exact.transfer(samples.s[k]);
      E[k] = detail::difference(samples, finite(samples.s[k]), k);
    };
  });
  samples.peak = MatrixXd::Zero(E.front().rows(), E.front().cols());
  for (const MatrixXcd& H : samples.H) samples.peak = samples.peak.cwiseMax(H.cwiseAbs());
  return E;
}

ErrorBound difference(const TransferAt& finite, const System& exact, const Scene& scene,
                      const std::vector<Complex>& poles) {
  require_some(exact.inputs(), "input");
  require_some(exact.outputs(), "output");
  const detail::Band band = band_of(scene, poles);
  detail::Samples samples;
  samples.omega = points(scene, band, poles);
  for (const double omega : samples.omega) samples.s.push_back(detail::on_ray(scene, omega));
  const std::vector<MatrixXcd> E = differences(finite, exact, samples);
  detail::refuse_growing(exact, scene, band, samples);
  ErrorBound b;
  const detail::ZeroPairs zero(detail::data_of(exact), samples.H);
  const MatrixXd peak = zero.cleared(samples.peak);
  b.peak = detail::with_floor(peak.cwiseMax(detail::kNearlyZero * zero.of_ports(peak)),
                              detail::kNearlyZero);
  b.pairs = MatrixXd::Zero(b.peak.rows(), b.peak.cols());
  for (std::size_t k = 0; k < E.size(); ++k) {
    const MatrixXd e = E[k].cwiseAbs().cwiseQuotient(b.peak);
    if (e.maxCoeff() > b.pairs.maxCoeff()) b.hertz = samples.omega[k] / (2 * std::numbers::pi);
    b.pairs = b.pairs.cwiseMax(e);
  }
  b.pairs = b.pairs.array() / std::cos(detail::kPhase / 2) + detail::kOfTransfer;
  Index i = 0, j = 0;
  b.worst = b.pairs.maxCoeff(&i, &j);
  b.output = exact.outputs()[static_cast<std::size_t>(i)];
  b.input = exact.inputs()[static_cast<std::size_t>(j)];
  b.samples = static_cast<int>(samples.omega.size());
  return b;
}

std::vector<Complex> poles_of(const std::vector<KeptMode>& modes) {
  std::vector<Complex> result;
  for (const KeptMode& m : modes) {
    const double omega = 2 * std::numbers::pi * m.hertz;
    const Complex root = std::sqrt(Complex(m.damping * m.damping - 1, 0));
    result.push_back(omega * (root - m.damping));
    result.push_back(omega * (-root - m.damping));
  }
  return result;
}

/// All poles, both of each pair.
std::vector<Complex> with_conjugates(const std::vector<Pole>& list) {
  std::vector<Complex> result;
  for (const Pole& p : list) {
    result.push_back(p.s);
    if (p.pair) result.push_back(std::conj(p.s));
  }
  return result;
}

}  // namespace

ErrorBound compare(const System& finite, const System& exact, const Scene& scene) {
  detail::check(scene);
  require_same(finite.inputs(), exact.inputs(), "inputs");
  require_same(finite.outputs(), exact.outputs(), "outputs");
  return difference([&](Complex s) { return finite.transfer(s); }, exact, scene,
                    with_conjugates(finite.poles()));
}

ErrorBound compare(const ReducedSystem& reduced, const System& exact) {
  require_same(reduced.inputs(), exact.inputs(), "inputs");
  require_same(reduced.outputs(), exact.outputs(), "outputs");
  return difference([&](Complex s) { return reduced.transfer(s); }, exact, reduced.scene(),
                    poles_of(reduced.modes()));
}

}  // namespace titop
