#include <optional>
#include <string_view>
#include <titop/analysis/reduction/coordinates.hpp>
#include <titop/analysis/reduction/coupled_springs.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop::detail {

using linalg::at;

namespace {

/// Stiffness and damping of a block's coordinates q: its states are q, then qd. Of a bushing the
/// first six outputs are K q + C qd; of a body whose damping couples its modes qdd = -K q - C qd.
/// None of other blocks.
std::optional<CoupledSpring> matrices(std::string_view type, const Dynamics& d) {
  if (d.modes && !d.modal) {
    const Eigen::Index n = d.modes->stiffness.size();
    return CoupledSpring{
        {}, d.modes->stiffness.asDiagonal().toDenseMatrix(), -d.A.block(n, n, n, n)};
  }
  if (type != "Bushing" || d.A.rows() != 12) return {};
  const Matrix6 K = d.C.topLeftCorner<6, 6>(), C = d.C.topRightCorner<6, 6>();
  if (K.isDiagonal(0) && C.isDiagonal(0)) return {};
  return CoupledSpring{{}, K, C};
}

}  // namespace

std::vector<CoupledSpring> coupled_springs(const SystemData& data,
                                           const std::vector<int>& coordinate) {
  const Layout& l = data.layout();
  std::vector<CoupledSpring> springs;
  for (const int node : l.state_nodes) {
    const auto all =
        matrices(data.graph().nodes[at(node)].block->type(), *data.numbers.blocks[at(node)]);
    if (!all) continue;
    CoupledSpring spring;
    std::vector<int> own;
    for (int i = 0; i < all->K.rows(); ++i)
      if (const int q = coordinate[at(l.state_first[at(node)] + i)]; q >= 0 && all->K(i, i) > 0) {
        own.push_back(i);
        spring.list.push_back(q);
      }
    spring.K = all->K(own, own);
    spring.C = all->C(own, own);
    if (!own.empty() && weak_pivot(spring.K, linalg::kMatrixDigits) < 0)
      springs.push_back(std::move(spring));
  }
  return springs;
}

}  // namespace titop::detail
