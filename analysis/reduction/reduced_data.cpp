#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/analysis/reduction/reduced_data.hpp>

namespace titop::detail {

using Eigen::Index;

std::vector<KeptMode> kept_modes(const Whole& whole, const Small& small) {
  std::vector<KeptMode> result;
  const Eigen::MatrixXd shares = participation(whole, small.V);
  for (Index j = 0; j < small.order(); ++j) {
    KeptMode mode;
    const double omega = std::sqrt(small.k(j));
    mode.hertz = omega / (2 * std::numbers::pi);
    if (small.Z.size() > 0 && omega > 0) mode.damping = small.Z(j, j) / (2 * omega);
    mode.exact = small.V.col(j).cwiseAbs().maxCoeff() == 1;
    for (Index i = 0; i < shares.rows(); ++i)
      if (shares(i, j) >= 0.05)
        mode.blocks.emplace_back(whole.blocks[static_cast<std::size_t>(i)], shares(i, j));
    std::stable_sort(mode.blocks.begin(), mode.blocks.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    result.push_back(std::move(mode));
  }
  return result;
}

}  // namespace titop::detail
