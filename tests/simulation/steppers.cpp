#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <titop/graph/linalg/eigen.hpp>

#include "scenes.hpp"
#include "support/mistakes.hpp"

/// Orders of convergence, energy, and limits of stability, against theory.

using namespace titop;
using namespace simulation_test;

namespace {

const std::vector<double> kMass{1, 2, 3, 4, 5}, kStiffness{10, 26, 33, 20, 95};

Eigen::VectorXd let_go() {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(10);
  for (int i = 0; i < 5; ++i) x(2 * i) = 0.1 * (i + 1) * (i % 2 ? -1 : 1);
  return x;
}

Eigen::VectorXd end_of(const System& s, Stepper stepper, double h) {
  return simulate(s, Excitation::none(),
                  {.step = h, .until = 4, .stepper = stepper, .x0 = let_go()})
      .x;
}

}  // namespace

TEST_CASE("orders: midpoint 2, Runge-Kutta 4, from halving the step") {
  const System s = compile(row_of_masses(kMass, kStiffness, 0.3));
  const Eigen::VectorXd exact = end_of(s, Stepper::exact, 0.5);
  const auto order = [&](Stepper stepper, double h) {
    return std::log2((end_of(s, stepper, h) - exact).norm() /
                     (end_of(s, stepper, h / 2) - exact).norm());
  };
  CHECK(std::abs(order(Stepper::midpoint, 1.0 / 256) - 2) <= 0.01);
  CHECK(std::abs(order(Stepper::rk4, 1.0 / 64) - 4) <= 0.05);
}

TEST_CASE("orders: a sine as input is a line in every step, which costs h^2 by any stepper") {
  const double m = 2, k = 18, c = 1.2, w = 2;
  const System s = compile(mass_on_spring(m, k, c));
  const std::complex<double> j(0, 1), G = 1.0 / (k + j * w * c - w * w * m);
  const Eigen::Vector2d steady(G.imag(), (j * w * G).imag());  // x = Im(G e^jwt), from the start
  const auto error = [&](Stepper stepper, double h) {
    const Trajectory t = simulate(s, Excitation::function([&](double time) {
                                    return Eigen::VectorXd::Constant(1, std::sin(w * time));
                                  }),
                                  {.step = h, .until = 4, .stepper = stepper, .x0 = steady});
    return std::abs(t.y(0, Eigen::last) - (G * std::exp(j * w * 4.0)).imag());
  };
  for (const Stepper stepper : {Stepper::exact, Stepper::midpoint, Stepper::rk4}) {
    CAPTURE(to_string(stepper));
    CHECK(std::abs(std::log2(error(stepper, 1.0 / 64) / error(stepper, 1.0 / 128)) - 2) <= 0.02);
  }
}

namespace {

/// 40 steps of 0.03 under a sine: through the factors, and by the dense matrices over these.
double difference_to_matrices(const System& s, const Eigen::VectorXd& x0) {
  StateSpace m;
  s.write(m);
  const double h = 0.03;
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(m.order(), m.order());
  const Eigen::PartialPivLU<Eigen::MatrixXd> left(I - h / 2 * m.A);
  Eigen::VectorXd x = x0;
  for (int k = 0; k < 40; ++k) {
    const double u = 0.5 * (std::sin(k * h) + std::sin((k + 1) * h));
    x = left.solve((I + h / 2 * m.A) * x + h * m.B.col(0) * u);
  }
  const Trajectory t =
      simulate(s, Excitation::function([](double time) {
                 return Eigen::VectorXd::Constant(1, std::sin(time));
               }),
               {.step = h, .until = 40 * h, .stepper = Stepper::midpoint, .x0 = x0});
  const Eigen::VectorXd y = m.C * x + m.D * std::sin(40 * h);
  return std::max((t.x - x).norm() / x.norm(), (t.y.col(t.y.cols() - 1) - y).norm() / y.norm());
}

/// A force on the point without mass between two springs: the model's states are those of the
/// blocks less a multiple of it.
System loaded_point() {
  Diagram d{"loaded"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 7, .stiffness = 30}),
       z2 = d.add("z2", SpringMass{.mass = 2, .stiffness = 50});
  z1.child.accel = 0;
  z1.parent.force = -u;
  z2.parent.accel = z1.parent.accel;
  z1.parent.force += -z2.parent.force;
  d.output("x1") = -1.0 * z1.stretch;
  return compile(d);
}

}  // namespace

TEST_CASE("midpoint: through the factors as from the dense matrices") {
  CHECK(difference_to_matrices(compile(row_of_masses(kMass, kStiffness, 0.3)), let_go()) <= 1e-13);
  CHECK(difference_to_matrices(loaded_point(), Eigen::Vector2d(0.3, -1.1)) <= 1e-13);
}

namespace {

/// A filter of three states without modal form, alone or with its output added to its input.
System filter_of_three(const Eigen::Matrix3d& A, const Eigen::RowVector3d& C, bool closed) {
  Diagram d{"filter"};
  auto u = d.input("u");
  auto K = d.add("K", Lti{.A = A, .B = Eigen::Vector3d(1, 0, 0), .C = C});
  if (closed)
    K.in = u + K.out;
  else
    K.in = u;
  d.output("y") = K.out;
  return compile(d);
}

}  // namespace

TEST_CASE("midpoint: blocks without modal form, whose pivots lie in other rows") {
  const Eigen::Matrix3d chain{{-1, 0, 0}, {-1, 0, 0}, {0, -4, 0}};
  const Eigen::Matrix3d companion{{-2.2, -0.41, -0.02}, {1, 0, 0}, {0, 1, 0}};
  const Eigen::Vector3d x0(0.3, -1.1, 0.7);
  CHECK(difference_to_matrices(filter_of_three(chain, {0, 0, 1}, false), x0) <= 1e-13);
  CHECK(difference_to_matrices(filter_of_three(companion, {0, 0, 0.02}, true), x0) <= 1e-13);
}

TEST_CASE("energy: midpoint and exact keep it over 100,000 steps, Runge-Kutta loses it") {
  const System s = compile(row_of_masses(kMass, kStiffness));
  const double before = energy(kMass, kStiffness, let_go());
  const auto drift = [&](Stepper stepper, int steps) {
    const double h = 0.1;
    const Trajectory t = simulate(
        s, Excitation::none(), {.step = h, .until = steps * h, .stepper = stepper, .x0 = let_go()});
    return energy(kMass, kStiffness, t.x) / before - 1;
  };
  CHECK(std::abs(drift(Stepper::midpoint, 100000)) <= 1e-11);
  CHECK(std::abs(drift(Stepper::exact, 100000)) <= 1e-10);
  CHECK(drift(Stepper::rk4, 10000) <= -1e-3);  // |R(i z)|^2 = 1 - z^6/72 + ...
}

TEST_CASE("limit: Runge-Kutta on the axis, on the real line, and refused beyond") {
  const auto limit_of = [](double k, double c) {
    return rk4_limit(compile(mass_on_spring(2, k, c)));
  };
  CHECK(std::abs(limit_of(18, 0) * 3 / std::sqrt(8.0) - 1) <= 1e-9);
  // c large: real poles at -c/(2m) -+ sqrt(...); the far one decides. 2.785... solves R(-z) = 1.
  const double far = 10 / 2.0 + std::sqrt(25.0 - 9);
  CHECK(std::abs(limit_of(18, 20) * far / 2.785293563405282 - 1) <= 1e-9);
  const System s = compile(mass_on_spring(2, 18, 0));
  const double limit = rk4_limit(s);
  const auto largest = [&](double h) {
    return simulate(s, Excitation::none(),
                    {.step = h,
                     .until = 2000 * h,
                     .stepper = Stepper::rk4,
                     .x0 = Eigen::Vector2d(1, 0),
                     .keep_states = true})
        .x.cwiseAbs()
        .maxCoeff();
  };
  CHECK(largest(0.999 * limit) <= 3.001);  // rates reach omega
  CHECK(titop_test::says(titop_test::error_of([&] { largest(1.001 * limit); }), Code::bad_value,
                         {"mass on a spring", "0.942809 s"}));
}

TEST_CASE("limit: beyond it the rule does grow") {
  // The refusal is right: the same steps by hand, from the rule's own growth factor.
  const double z = 1.001 * std::sqrt(8.0);
  const double growth =
      std::abs(std::complex<double>(1 - z * z / 2 + z * z * z * z / 24, z - z * z * z / 6));
  CHECK(growth > 1);
}
