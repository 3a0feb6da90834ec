// Reduced models of distributed beams as port-Hamiltonian systems: structure, energy, passivity.
#include <doctest/doctest.h>

#include <titop/blocks/exact_beam.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"
#include "support/rng.hpp"

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop_test::error_of;
using titop_test::Rng;
using titop_test::says;
using Complex = std::complex<double>;

namespace {

ExactBeam boom(double length, double side) {
  return {.length = length,
          .section = rectangle(side, 0.7 * side),
          .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
          .damping = {.stiffness = 2e-5}};
}

/// Two booms on a free hub, skew; forces on the hub and on a tip, accelerations there.
Diagram satellite(bool rate = false) {
  Diagram d{"satellite"};
  auto hub = d.add("hub", RigidBody{.mass = 30,
                                    .inertia = Vector3d(4, 5, 6).asDiagonal(),
                                    .children = {{"a", {0.3, 0, 0}}, {"b", {-0.3, 0.1, 0}}}});
  auto a = d.add("a", boom(2.2, 0.04)), b = d.add("b", boom(1.7, 0.03));
  mount(a, hub.child("a"), Rotation::about({1, 1, 0}, 0.6));
  mount(b, hub.child("b"), Rotation::about({0, 1, 1}, 2.5));
  hub.parent.force = -d.input("U", 6);
  b.child("C").force += d.input("F", 6);
  if (rate) d.output("v", 3) = a.child("C").rate.linear();
  d.output("hub", 6) = hub.parent.accel;
  d.output("tip", 6) = b.child("C").accel;
  return d;
}

const Scene kScene{.band_hz = {0, 40}, .accuracy = 1e-2};

double least_eigenvalue(const MatrixXcd& hermitian) {
  return Eigen::SelfAdjointEigenSolver<MatrixXcd>(hermitian, Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

/// Least eigenvalue of the Hermitian part of Y(s) / s, from forces to rates, over its largest
/// diagonal entry; every port scaled to its own.
double passivity(const MatrixXcd& Y, Complex s) {
  const MatrixXcd rate = Y / s, part = (rate + rate.adjoint()) / 2;
  const VectorXd unit = part.diagonal().real().cwiseSqrt().cwiseInverse();
  return least_eigenvalue(unit.asDiagonal() * part * unit.asDiagonal());
}

}  // namespace

TEST_CASE("a reduced model of distributed beams is port-Hamiltonian, with the same transfer") {
  const ReducedBeams r = reduce_beams(satellite(), kScene);
  const PortHamiltonian h = port_hamiltonian(r.system.second_order());
  const Eigen::Index n = h.N.cols();
  CHECK(2 * n == r.system.order());
  CHECK(h.J == -h.J.transpose());
  CHECK(h.R == h.R.transpose());
  CHECK(h.Q == h.Q.transpose());
  CHECK(least_eigenvalue(h.R.cast<Complex>()) >= -1e-14 * h.R.norm());
  CHECK(least_eigenvalue(h.Q.cast<Complex>()) >= 0);
  const StateSpace model = h.state_space();
  for (const double omega : {3.0, 60.0, 140.0, 251.0}) {
    const Complex s(0.02 * omega, omega);
    const MatrixXcd Y = r.system.transfer(s);
    CHECK((model.transfer(s) - Y).cwiseAbs().maxCoeff() <= 1e-9 * Y.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("energy balance: what ports supply is stored or dissipated, to rounding") {
  const PortHamiltonian h =
      port_hamiltonian(reduce_beams(satellite(), kScene).system.second_order());
  const StateSpace model = h.state_space();
  Rng rng(7);
  // The midpoint rule keeps the balance of every step exactly, whatever its size.
  const double step = 2e-3;
  const Eigen::Index n = model.order();
  const MatrixXd half = MatrixXd::Identity(n, n) - step / 2 * model.A;
  VectorXd x = VectorXd::Zero(n);
  double supplied = 0, dissipated = 0, turned_over = 0;
  for (int k = 0; k < 400; ++k) {
    VectorXd u(12);
    for (double& force : u) force = k < 200 ? rng.between(-1, 1) : 0;
    const VectorXd rate = half.partialPivLu().solve(model.A * x + model.B * u),
                   middle = x + step / 2 * rate;
    x += step * rate;
    supplied += step * h.supplied(middle, u);
    turned_over += step * std::abs(h.supplied(middle, u));
    CHECK(h.dissipated(middle) >= 0);
    dissipated += step * h.dissipated(middle);
  }
  CHECK(dissipated > 0);
  CHECK(h.energy(x) > 0);
  CHECK(std::abs(supplied - dissipated - h.energy(x)) <= 1e-10 * turned_over);
}

TEST_CASE("collocated forces and accelerations: passive, as the distributed beams are") {
  const Diagram d = satellite();
  const System exact = compile(d);
  const ReducedBeams r = reduce_beams(d, kScene);
  const PortHamiltonian h = port_hamiltonian(r.system.second_order());
  // Forces on the hub act against its parent's wrench: u = -F, and so with the same sign.
  const MatrixXd lower = h.G.bottomRows(h.N.cols());
  CHECK((h.N - lower.transpose()).norm() <= 1e-9 * lower.norm());
  CHECK((h.P - h.P.transpose()).norm() <= 1e-9 * h.P.norm());
  Rng rng(3);
  for (int k = 0; k < 30; ++k) {
    const double omega = std::pow(10, rng.between(-1, 4));
    const Complex s(omega * std::pow(10, rng.between(-3, 0)), rng.chance(0.2) ? 0 : omega);
    CHECK(passivity(r.system.transfer(s), s) >= -1e-7);
    CHECK(passivity(exact.transfer(s), s) >= -1e-7);
  }
}

TEST_CASE("the energy of a clamped beam under a force at its end: F^2 L^3 / (6 E I)") {
  const ExactBeam beam = boom(2, 0.05);
  Diagram d{"cantilever"};
  auto b = d.add("b", beam);
  b.parent.accel = 0;
  b.child("C").force = d.input("F", 6);
  d.output("a", 6) = b.child("C").accel;
  const ReducedBeams r = reduce_beams(d, {.band_hz = {0, 100}, .accuracy = 1e-4});
  const PortHamiltonian h = port_hamiltonian(r.system.second_order());
  const Eigen::Index n = h.N.cols();
  const double force = 3;
  VectorXd x = VectorXd::Zero(2 * n);
  x.head(n) = h.Q.topLeftCorner(n, n).ldlt().solve(h.G.bottomRows(n).col(2)) * force;
  const double right =
      force * force * std::pow(beam.length, 3) / (6 * beam.material.E * beam.section.I_y);
  CHECK(h.energy(x) <= right * (1 + 1e-6));  // a projection: never softer
  CHECK(h.energy(x) >= right * (1 - 1e-3));
}

TEST_CASE("outputs that are no accelerations have no such form: refused by name") {
  const Scene scene{.band_hz = {0.5, 40}, .accuracy = 1e-2};
  const Error error = error_of(
      [&] { port_hamiltonian(reduce_beams(satellite(true), scene).system.second_order()); });
  CHECK(says(error, Code::bad_value, {"v(1)", ".accel"}));
  SecondOrderModel model =
      reduce_beams(satellite(), {.band_hz = {0, 5}, .accuracy = 0.1}).system.second_order();
  model.M(0, 0) = -1;
  CHECK(says(error_of([&] { port_hamiltonian(model); }), Code::bad_value, {"positive definite"}));
}
