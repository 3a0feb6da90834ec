#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>

#include "by_hand.hpp"

/// A beam alone in a scene, (14), with either side of either end imposed, against the finite
/// elements themselves: no modes, no inversion.

using namespace scenes_test;
using namespace titop;

namespace {

const Tube kTube{1.7, 0.05, 0.04, 3};

struct Imposed {
  bool motion_at_C, motion_at_P;
};

Diagram alone(const FlexibleBody& body, Imposed imposed) {
  Diagram d{"alone"};
  auto at_C = d.input("at_C", 6);
  auto at_P = d.input("at_P", 6);
  auto b = d.add("b", body);
  if (imposed.motion_at_C) {
    b.child.accel = at_C;
    d.output("y_C", 6) = b.child.force;
  } else {
    b.child.force = at_C;
    d.output("y_C", 6) = b.child.accel;
  }
  if (imposed.motion_at_P) {
    b.parent.accel = at_P;
    d.output("y_P", 6) = b.parent.force;
  } else {
    b.parent.force = at_P;
    d.output("y_P", 6) = b.parent.accel;
  }
  return d;
}

using Long = std::complex<long double>;
using MatrixXl = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;

/// In long double, since at low frequency stiffness hides the inertia under test.
///
/// Unknowns [x_P; q; F_C; F_P] of the equation of motion s^2 M x + K x = S'F_C - E'F_P, and the
/// imposed signals.
MatrixXcd direct(const by_hand::Beam& beam, Imposed imposed, Complex s) {
  const by_hand::FreeBeam fe = by_hand::free_beam(beam);
  const Index n = fe.M.rows();
  MatrixXd Y = MatrixXd::Zero(n, n);
  Y.leftCols(6) = by_hand::rigid_motion(beam);
  Y.bottomRightCorner(n - 6, n - 6).setIdentity();
  MatrixXd K = MatrixXd::Zero(n, n);
  K.bottomRightCorner(n - 6, n - 6) = fe.K.bottomRightCorner(n - 6, n - 6);
  const MatrixXd M = Y.transpose() * fe.M * Y, S = Y.bottomRows(6);
  const MatrixXl Ml = M.cast<Long>(), Kl = K.cast<Long>(), Sl = S.cast<Long>();
  const Long z = s;
  MatrixXl E = MatrixXl::Zero(n + 12, n + 12), load = MatrixXl::Zero(n + 12, 12);
  E.topLeftCorner(n, n) = z * z * Ml + Kl;
  E.block(0, n, n, 6) = -Sl.transpose();
  E.block(0, n + 6, 6, 6).setIdentity();
  load.block(n, 0, 12, 12).setIdentity();
  if (imposed.motion_at_C)
    E.block(n, 0, 6, n) = z * z * Sl;
  else
    E.block(n, n, 6, 6).setIdentity();
  if (imposed.motion_at_P)
    E.block(n + 6, 0, 6, 6) = z * z * MatrixXl::Identity(6, 6);
  else
    E.block(n + 6, n + 6, 6, 6).setIdentity();
  const MatrixXl x = E.fullPivLu().solve(load);
  MatrixXl y(12, 12);
  y.topRows(6) =
      imposed.motion_at_C ? MatrixXl(x.middleRows(n, 6)) : MatrixXl(z * z * Sl * x.topRows(n));
  y.bottomRows(6) =
      imposed.motion_at_P ? MatrixXl(x.bottomRows(6)) : MatrixXl(z * z * x.topRows(6));
  return y.cast<Complex>();
}

}  // namespace

TEST_CASE("(14) and its inverses in a scene against the finite elements") {
  const FlexibleBody body = kTube.beam();
  const auto s = points({10, 100, 400, 1500, 5000, 20000});
  for (const Imposed imposed :
       {Imposed{false, true}, Imposed{false, false}, Imposed{true, true}, Imposed{true, false}}) {
    INFO("motion imposed at C ", imposed.motion_at_C, ", at P ", imposed.motion_at_P);
    const System system = compile(alone(body, imposed));
    std::vector<MatrixXcd> exact;
    for (const Complex z : s) exact.push_back(direct(kTube.numbers(), imposed, z));
    // Inverted, (14) has the small residual mass at P, the difference D_P - L_P'L_P, and a sum over
    // many high modes, Phi_C Phi_C': some digits of its data are lost there.
    const bool as_written = !imposed.motion_at_C && imposed.motion_at_P;
    CHECK(error_3(responses(system, s), exact) <= (as_written ? 1e-12 : 1e-10));
    CHECK(error_3(responses(system.state_space(), s), exact) <= (as_written ? 1e-10 : 1e-9));
  }
}

TEST_CASE("port-Hamiltonian forms have the transfers of (5) and (14)") {
  const SpringMass spring{.mass = 3, .stiffness = 70, .damping = 0.4, .parent_mass = 2};
  const auto low = points({0.5, 4, 6, 50});
  StateSpace two_port = model_of(spring);
  two_port.C = two_port.C.topRows(2).eval();
  two_port.D = two_port.D.topRows(2).eval();
  CHECK(titop_test::transfer_error(responses(port_hamiltonian(spring).state_space(), low),
                                   responses(two_port, low), {1, 1}, {1, 1}) <= 1e-14);
  Beam beam = kTube.beam();
  beam.modes.xi = {0.02};
  const FlexibleBody body = beam;
  const auto high = points({10, 100, 1000, 10000});
  CHECK(error_3(responses(port_hamiltonian(body).state_space(), high),
                responses(model_of(body), high)) <= 1e-12);
}
