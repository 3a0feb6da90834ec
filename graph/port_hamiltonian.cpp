#include <fmt/format.h>

#include <titop/graph/error.hpp>
#include <titop/graph/port_hamiltonian.hpp>

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

}  // namespace titop
