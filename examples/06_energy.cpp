// A block is also a port-Hamiltonian system (eqs 7, 17): the rate of its energy is the power
// supplied at its ports minus the power dissipated by damping. The balance holds along any
// trajectory, here to rounding.
#include <Eigen/LU>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Energy, and the two sides of its balance, along a trajectory under u(t) from rest.
struct Course {
  double stored = 0, supplied = 0, dissipated = 0, largest = 0;  ///< [J]
  VectorXd x;
};

/// Implicit midpoint rule: x+ = x + h f((x + x+) / 2). On a quadratic energy it keeps the balance
/// exactly: H(x+) - H(x) = h * (power at the midpoint).
template <class Input>
Course integrate(const PortHamiltonian& s, double h, int steps, Input u) {
  const auto n = s.Q.rows();
  const MatrixXd A = (s.J - s.R) * s.Q, I = MatrixXd::Identity(n, n);
  const Eigen::PartialPivLU<MatrixXd> left(I - h / 2 * A);
  Course t{.x = VectorXd::Zero(n)};
  for (int i = 0; i < steps; ++i) {
    const VectorXd load = u((i + 0.5) * h);
    const VectorXd next = left.solve((I + h / 2 * A) * t.x + h * (s.G * load));
    const VectorXd middle = (t.x + next) / 2;
    t.supplied += h * s.supplied(middle, load);
    t.dissipated += h * s.dissipated(middle);
    t.x = next;
    t.largest = std::max(t.largest, s.energy(t.x));
  }
  t.stored = s.energy(t.x);
  return t;
}

bool report(const char* name, const Course& t) {
  std::printf("%s: supplied %.6f J, dissipated %.6f J, stored %.6f J\n", name, t.supplied,
              t.dissipated, t.stored);
  return by_hand::agrees("  balance", std::abs(t.stored - t.supplied + t.dissipated) / t.largest,
                         1e-11);
}

/// Largest difference of two transfers at a few points.
double difference(const StateSpace& a, const StateSpace& b, Eigen::Index block) {
  std::vector<by_hand::MatrixXcd> left, right;
  for (const double w : {1.0, 30.0, 300.0, 3000.0}) {
    left.push_back(a.transfer({0.1 * w, w}));
    right.push_back(b.transfer({0.1 * w, w}));
  }
  return by_hand::transfer_error(left, right, block, block);
}

}  // namespace

int main() {
  // Eq. (7), by hand: H = p^2 / 2m + k q^2 / 2, qdot = p / m, pdot = -k q - c qdot + f - m xdd_P.
  const SpringMass spring{.mass = 2, .stiffness = 50, .damping = 0.3, .parent_mass = 0.5};
  const PortHamiltonian s = port_hamiltonian(spring);
  const Course a = integrate(s, 1e-3, 5000, [](double t) -> VectorXd {
    return Eigen::Vector2d(3 * std::sin(4 * t), 0.5 * std::cos(7 * t));  // [N], [m/s^2]
  });
  bool ok = report("spring-mass", a);
  const double by_hand_energy = a.x(1) * a.x(1) / (2 * 2) + 50 * a.x(0) * a.x(0) / 2;
  ok &= by_hand::agrees("  H is eq. (7)", std::abs(a.stored / by_hand_energy - 1), 1e-14);
  StateSpace two_port = model_of(spring);  // without the stretch reading
  two_port.C = two_port.C.topRows(2).eval();
  two_port.D = two_port.D.topRows(2).eval();
  ok &= by_hand::agrees("  the same transfer as eq. (5)", difference(s.state_space(), two_port, 1),
                        1e-13);

  // Eq. (17) with the modes of a beam: shaken at its root, pushed at its tip.
  const FlexibleBody beam = Beam{.length = 1.5,
                                 .section = rectangle(0.04, 0.01),
                                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                 .elements = 4,
                                 .modes = {.xi = {0.01}}};
  const PortHamiltonian b = port_hamiltonian(beam);
  const Course c = integrate(b, 2e-4, 10000, [](double t) {
    VectorXd u = VectorXd::Zero(12);
    u(2) = 2 * std::sin(30 * t);    // force at the tip along z [N]
    u(7) = 4 * std::exp(-t);        // acceleration of the root along y [m/s^2]
    u(9) = 1.5 * std::cos(12 * t);  // and about x [rad/s^2]
    return u;
  });
  ok &= report("beam", c);
  const Eigen::Index N = beam.data().omega.size();
  const double modal =
      (c.x.tail(N).squaredNorm() + beam.data().omega.cwiseProduct(c.x.head(N)).squaredNorm()) / 2;
  ok &= by_hand::agrees("  H is eq. (17) in modal coordinates", std::abs(c.stored / modal - 1),
                        1e-13);
  ok &= by_hand::agrees("  the same transfer as eq. (14)",
                        difference(b.state_space(), model_of(beam), 3), 1e-11);

  // Free of loads and damping nothing changes: the energy given at the start is there at the end.
  PortHamiltonian lossless = b;
  lossless.R.setZero();
  const MatrixXd skew = lossless.J + lossless.J.transpose();
  ok &= skew.isZero(0);
  std::printf("J is skew, R is %s\n",
              (b.R - b.R.transpose()).isZero(0) && b.R.diagonal().minCoeff() >= 0
                  ? "symmetric and not negative"
                  : "WRONG");
  return ok ? 0 : 1;
}
