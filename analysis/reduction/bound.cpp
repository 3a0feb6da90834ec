#include <numbers>
#include <titop/analysis/reduction/bound.hpp>

namespace titop::detail {

using Eigen::Index;
using Eigen::MatrixXd;

ErrorBound error_bound(const System& full, const Scene& scene, const Band& band,
                       const SampledSpectrum& spectrum,
                       const std::vector<std::complex<double>>& poles, const TransferOf& transfer) {
  const auto points = sample_points(scene, band, spectrum, poles, kPhase);
  const Samples check = sample(full, scene, spectrum, points);
  const Index outputs = check.peak.rows(), inputs = check.peak.cols();
  ErrorBound b;
  b.kind = scene.bound;
  b.samples = static_cast<int>(points.size());
  b.pairs = MatrixXd::Constant(outputs, inputs, -1);
  Eigen::MatrixXi where = Eigen::MatrixXi::Zero(outputs, inputs);  // sample of the largest error
  MatrixXd moves = MatrixXd::Zero(outputs, inputs);                // 0: exactly 0 in both models
  for (std::size_t k = 0; k < check.s.size(); ++k) {
    const MatrixXd e =
        difference(check, transfer(check.s[k]), k).cwiseAbs().cwiseQuotient(check.peak);
    where = (e.array() > b.pairs.array()).select(static_cast<int>(k), where);
    b.pairs = b.pairs.cwiseMax(e);
    moves = moves.cwiseMax(e + check.H[k].cwiseAbs());
  }
  b.peak = check.peak;
  b.pairs = b.pairs / std::cos(kPhase / 2) + rounding(check, nearest_pole(scene, band, spectrum));
  b.pairs = (moves.array() > 0).select(b.pairs, 0);
  Index i = 0, j = 0;
  b.worst = b.pairs.maxCoeff(&i, &j);
  const auto at = [](Index k) { return static_cast<std::size_t>(k); };
  b.output = full.outputs()[at(i)];
  b.input = full.inputs()[at(j)];
  b.hertz = check.omega[at(where(i, j))] / (2 * std::numbers::pi);
  return b;
}

}  // namespace titop::detail
