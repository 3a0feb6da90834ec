#include "support/fine_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/graph/support/parallel.hpp>

namespace titop_bench {
namespace {

std::vector<double> points(const titop::Scene& scene, int steps, const Eigen::VectorXd& poles) {
  const double low = 2 * std::numbers::pi * scene.band_hz[0],
               high = 2 * std::numbers::pi * scene.band_hz[1];
  std::vector<double> omega;
  for (int i = low > 0 ? 0 : 1; i <= steps; ++i) omega.push_back(low + (high - low) * i / steps);
  for (const double pole : poles)
    for (int i = -6; i <= 6; ++i)
      if (const double w = pole * (1 + 0.4 * scene.damping_floor * i); w > low && w < high)
        omega.push_back(w);
  return omega;
}

}  // namespace

FineGrid::FineGrid(const titop::System& full, const titop::Scene& scene, int steps,
                   const Eigen::VectorXd& poles, const Eigen::MatrixXd& least)
    : peak_(least) {
  const double zeta = scene.damping_floor;
  for (const double omega : points(scene, steps, poles))
    s_.emplace_back(zeta * omega, std::sqrt(1 - zeta * zeta) * omega);
  H_.resize(s_.size());
  titop::detail::parallel(s_.size(), 0,
                          [&] { return [&](std::size_t k) { H_[k] = full.transfer(s_[k]); }; });
  for (const Eigen::MatrixXcd& H : H_) peak_ = peak_.cwiseMax(H.cwiseAbs());
}

double FineGrid::error(const TransferOf& transfer) const {
  std::vector<double> worst(s_.size());
  titop::detail::parallel(s_.size(), 0, [&] {
    return [&](std::size_t k) {
      worst[k] = (transfer(s_[k]) - H_[k]).cwiseAbs().cwiseQuotient(peak_).maxCoeff();
    };
  });
  return *std::max_element(worst.begin(), worst.end());
}

}  // namespace titop_bench
