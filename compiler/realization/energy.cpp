#include <titop/compiler/realization/energy.hpp>
#include <titop/compiler/solve/factored.hpp>

namespace titop::detail {

using Eigen::MatrixXd;

MatrixXd potential_energy(const Factored& d) {
  const MatrixXd T =
      d.states.expanded(MatrixXd(MatrixXd::Identity(d.states.order(), d.states.order())));
  Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(T.rows());
  for (const int node : d.layout().state_nodes) {
    const auto i = static_cast<std::size_t>(node);
    const Dynamics& m = *d.numbers.blocks[i];
    const Block& block = *d.graph().nodes[i].block;
    if (!block.kinematics(d.numbers.parameters)) return {};
    const Eigen::VectorXd own = stiffness_of(block, m, d.numbers.parameters);
    stiffness.segment(d.layout().state_first[i], own.size()) = own;
  }
  return T.transpose() * stiffness.asDiagonal() * T;
}

}  // namespace titop::detail
