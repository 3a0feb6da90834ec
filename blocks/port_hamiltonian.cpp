#include <titop/blocks/body_interface.hpp>
#include <titop/blocks/port_hamiltonian.hpp>
#include <titop/graph/error.hpp>

namespace titop {

using Eigen::MatrixXd;
using Eigen::VectorXd;

PortHamiltonian port_hamiltonian(const SpringMass& spec) {
  const double m = spec.mass.nominal(), k = spec.stiffness.nominal();
  const double c = spec.damping.nominal(), m0 = spec.parent_mass.nominal();
  PortHamiltonian s = detail::canonical(MatrixXd::Constant(1, 1, c));
  s.Q = Eigen::Vector2d(k, 1 / m).asDiagonal();
  s.G = (MatrixXd(2, 2) << 0, 0, 1, -m).finished();
  s.N = (MatrixXd(2, 1) << 1 / m, -1).finished();
  s.P = (MatrixXd(2, 2) << 0, 1, 1, -(m0 + m)).finished();
  return s;
}

PortHamiltonian port_hamiltonian(const FlexibleBody& body) {
  const ModalData d = body.nominal();
  const auto n = d.omega.size();
  const MatrixXd W = modal_input(d);
  PortHamiltonian s = detail::canonical(body.damping());
  VectorXd stiffness = VectorXd::Ones(2 * n);
  stiffness.head(n) = d.omega.cwiseAbs2();
  s.Q = stiffness.asDiagonal();
  s.G = MatrixXd::Zero(2 * n, W.cols());
  s.G.bottomRows(n) = W;
  s.N = W.transpose();
  std::vector<Vector3d> PC;
  for (const ModalChild& c : d.children) PC.push_back(c.PC);
  s.P = rigid_part(PC, d.D_P, shapes_of_lines(d));
  return s;
}

}  // namespace titop
