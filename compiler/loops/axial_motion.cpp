#include <titop/compiler/loops/axial_motion.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::passes {

using Eigen::MatrixXd;
using linalg::at;

namespace {

bool rigid_along(const Kinematics& k) {
  for (std::size_t i = 0; i < k.Phi.size(); ++i) {
    if (static_cast<int>(i) == k.reference || k.Phi[i].rows() != 6) continue;
    // tau = [[I, (*CP)], [0, I]]
    const MatrixXd& tau = k.tau[i];
    const Eigen::Vector3d CP(tau(2, 4), tau(0, 5), tau(1, 3));
    const MatrixXd shapes = k.Phi[i].topRows<3>();
    if (CP.norm() > 0 &&
        (CP.normalized().transpose() * shapes).norm() <= linalg::kTextDigits * shapes.norm())
      return true;
  }
  return false;
}

}  // namespace

std::vector<std::string> without_axial_motion(const std::set<int>& nodes, const Stage& stage) {
  std::vector<std::string> names;
  for (const int i : nodes) {
    const Node& node = stage.graph.nodes[at(i)];
    const auto dynamics = node.block->dynamics(stage.values);
    if (!dynamics->modes || dynamics->modes->W.rows() == 0) return {};
    const auto k = node.block->kinematics(stage.values);
    if (k && rigid_along(*k)) names.push_back(node.name);
  }
  return names;
}

}  // namespace titop::passes
