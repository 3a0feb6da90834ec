#include <titop/compiler/realization/energy.hpp>
#include <titop/compiler/solve/factored.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Per state of a block: its stiffness if it is a position, else 0. Empty if the block does not
/// define its energy.
Eigen::VectorXd stiffness_of(const Block& block, const Dynamics& d, ParameterValues values) {
  const auto kinematics = block.kinematics(values);
  if (!kinematics) return {};
  if (kinematics->stiffness.size() == d.A.rows()) return kinematics->stiffness;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(d.A.rows());
  for (Index i = 0; i < d.A.rows(); ++i) {
    Index rate = -1;
    const bool position = d.A.row(i).cwiseAbs().maxCoeff(&rate) == 1 && d.A(i, rate) == 1 &&
                          d.A.row(i).cwiseAbs().sum() == 1;
    if (position && rate != i) result(i) = -d.A(rate, i);
  }
  return result;
}

}  // namespace

MatrixXd potential_energy(const Factored& d) {
  const MatrixXd T =
      d.states.expanded(MatrixXd(MatrixXd::Identity(d.states.order(), d.states.order())));
  Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(T.rows());
  for (const int node : d.layout().state_nodes) {
    const auto i = static_cast<std::size_t>(node);
    const Dynamics& m = *d.numbers.blocks[i];
    const Eigen::VectorXd own = stiffness_of(*d.graph().nodes[i].block, m, d.numbers.parameters);
    if (own.size() != m.A.rows()) return {};
    stiffness.segment(d.layout().state_first[i], own.size()) = own;
  }
  return T.transpose() * stiffness.asDiagonal() * T;
}

}  // namespace titop::detail
