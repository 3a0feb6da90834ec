#include <fmt/format.h>

#include <titop/blocks/body_interface.hpp>
#include <titop/blocks/port_hamiltonian.hpp>
#include <titop/graph/error.hpp>

namespace titop {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

void require_size(const char* name, const VectorXd& v, Eigen::Index size) {
  if (v.size() == size) return;
  throw Error(Code::size, fmt::format("PortHamiltonian: {} has {} entries", name, v.size()),
              fmt::format("give {}", size));
}

}  // namespace

PortHamiltonian detail::canonical(const MatrixXd& damping) {
  const auto n = damping.rows();
  PortHamiltonian s;
  s.J = MatrixXd::Zero(2 * n, 2 * n);
  s.J.topRightCorner(n, n).setIdentity();
  s.J.bottomLeftCorner(n, n) = -MatrixXd::Identity(n, n);
  s.R = MatrixXd::Zero(2 * n, 2 * n);
  s.R.bottomRightCorner(n, n) = damping;
  return s;
}

double PortHamiltonian::energy(const VectorXd& x) const {
  require_size("x", x, Q.rows());
  return 0.5 * x.dot(Q * x);
}

double PortHamiltonian::supplied(const VectorXd& x, const VectorXd& u) const {
  require_size("x", x, Q.rows());
  require_size("u", u, G.cols());
  return (Q * x).dot(G * u);
}

double PortHamiltonian::dissipated(const VectorXd& x) const {
  require_size("x", x, Q.rows());
  return (Q * x).dot(R * (Q * x));
}

StateSpace PortHamiltonian::state_space() const {
  const auto n = N.cols();
  StateSpace m;
  m.A = (J - R) * Q;
  m.B = G;
  m.C = N * m.A.bottomRows(n);
  m.D = N * G.bottomRows(n) + P;
  return m;
}

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
