#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <titop/analysis/distributed/compare.hpp>
#include <titop/analysis/reduction/bound.hpp>
#include <titop/analysis/reduction/phase_grid.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/support/parallel.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr int kFar = 10;         ///< pairs of poles in place of all beyond twice the band
constexpr double kStart = 1e-6;  ///< of the band's upper end, in place of lower frequencies

/// Frequencies of the band between which the phase of these poles, each counted twice, turns by
/// kPhase at most.
std::vector<double> points(const Scene& scene, const std::vector<Complex>& poles) {
  const double high = 2 * std::numbers::pi * scene.band_hz[1];
  const double low = std::max(2 * std::numbers::pi * scene.band_hz[0], kStart * high);
  if (!(high > low)) return {low};
  const Complex turn = std::conj(detail::on_ray(scene, 1));
  detail::PhaseBand band{low, high, {}, 2 * kFar};
  for (const Complex& p : poles)
    if (p != 0.0 && std::abs(p) <= 2 * high) band.poles.insert(band.poles.end(), 2, p * turn);
  return detail::phase_grid(band, detail::kPhase);
}

/// Pairs that are nearly 0 count as much as 1e-6 of their input and output.
MatrixXd with_floor(const MatrixXd& peak) {
  const auto [out, in] = detail::port_sizes(peak);
  const MatrixXd size = peak.cwiseMax(detail::kNearlyZero * out * in);
  return (peak.array() > 0).select(size, (size.array() > 0).select(size, 1));
}

void require_same(const std::vector<std::string>& finite, const std::vector<std::string>& exact,
                  const char* subject) {
  if (finite != exact)
    throw Error(Code::bad_value,
                fmt::format("the finite model and the exact one have different {}: {} ({}) and {} "
                            "({})",
                            subject, finite.size(), detail::some_names(finite), exact.size(),
                            detail::some_names(exact)),
                "compare models of the same scene, with the same inputs and outputs");
}

using TransferAt = std::function<MatrixXcd(Complex)>;

ErrorBound difference(const TransferAt& finite, const System& exact, const Scene& scene,
                      const std::vector<Complex>& poles) {
  const std::vector<double> omega = points(scene, poles);
  std::vector<MatrixXcd> H(omega.size()), E(omega.size());
  detail::parallel(omega.size(), 0, [&] {
    return [&](std::size_t k) {
      const Complex s = detail::on_ray(scene, omega[k]);
      H[k] = exact.transfer(s), E[k] = finite(s) - H[k];
    };
  });
  ErrorBound b;
  b.peak = b.pairs = MatrixXd::Zero(H.front().rows(), H.front().cols());
  for (const MatrixXcd& h : H) b.peak = b.peak.cwiseMax(h.cwiseAbs());
  b.peak = with_floor(b.peak);
  for (std::size_t k = 0; k < E.size(); ++k) {
    const MatrixXd e = E[k].cwiseAbs().cwiseQuotient(b.peak);
    if (e.maxCoeff() > b.pairs.maxCoeff()) b.hertz = omega[k] / (2 * std::numbers::pi);
    b.pairs = b.pairs.cwiseMax(e);
  }
  b.pairs = b.pairs.array() / std::cos(detail::kPhase / 2) + detail::kOfTransfer;
  Index i = 0, j = 0;
  b.worst = b.pairs.maxCoeff(&i, &j);
  b.output = exact.outputs()[static_cast<std::size_t>(i)];
  b.input = exact.inputs()[static_cast<std::size_t>(j)];
  b.samples = static_cast<int>(omega.size());
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
