#include <cmath>
#include <numbers>
#include <titop/compiler/economy/bound.hpp>

namespace titop::detail {

using Eigen::Index;
using Eigen::MatrixXd;

ErrorBound error_bound(const System& full, const Scene& scene, const Band& band,
                       const Spectrum& spectrum, const std::vector<std::complex<double>>& poles,
                       const TransferOf& transfer) {
  const auto points = sample_points(scene, band, spectrum, poles, kPhase);
  const Samples check = sample(full, scene, spectrum, points);
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  ErrorBound b;
  b.kind = scene.bound;
  b.samples = static_cast<int>(points.size());
  b.pairs = MatrixXd::Zero(check.peak.rows(), check.peak.cols());
  double worst = -1;
  for (std::size_t k = 0; k < check.s.size(); ++k) {
    const MatrixXd e =
        difference(check, transfer(check.s[k]), k).cwiseAbs().cwiseQuotient(check.peak);
    b.pairs = b.pairs.cwiseMax(e);
    Index i = 0, j = 0;
    if (const double here = e.maxCoeff(&i, &j); !(here <= worst)) {
      worst = here;
      b.output = full.outputs()[at(i)];
      b.input = full.inputs()[at(j)];
      b.hertz = check.omega[k] / (2 * std::numbers::pi);
    }
  }
  b.peak = check.peak;
  b.pairs = b.pairs / std::cos(kPhase / 2) + rounding(check);
  b.worst = b.pairs.maxCoeff();
  return b;
}

}  // namespace titop::detail
