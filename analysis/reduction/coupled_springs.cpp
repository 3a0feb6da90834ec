#include <titop/analysis/reduction/coordinates.hpp>
#include <titop/analysis/reduction/coupled_springs.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop::detail {

using linalg::at;

/// Of a bushing: states q, then qd; the first six outputs are K q + C qd.
std::vector<CoupledSpring> coupled_springs(const SystemData& data,
                                           const std::vector<int>& coordinate) {
  const Layout& l = data.layout();
  std::vector<CoupledSpring> springs;
  for (const int node : l.state_nodes) {
    const Dynamics& d = *data.numbers.blocks[at(node)];
    if (data.graph().nodes[at(node)].block->type() != "Bushing" || d.A.rows() != 12) continue;
    const Matrix6 K = d.C.topLeftCorner<6, 6>(), C = d.C.topRightCorner<6, 6>();
    if (K.isDiagonal(0) && C.isDiagonal(0)) continue;
    CoupledSpring spring;
    std::vector<int> axes;
    for (int i = 0; i < 6; ++i)
      if (const int q = coordinate[at(l.state_first[at(node)] + i)]; q >= 0 && K(i, i) > 0) {
        axes.push_back(i);
        spring.list.push_back(q);
      }
    spring.K = K(axes, axes);
    spring.C = C(axes, axes);
    if (!axes.empty() && weak_pivot(spring.K, linalg::kMatrixDigits) < 0)
      springs.push_back(std::move(spring));
  }
  return springs;
}

}  // namespace titop::detail
