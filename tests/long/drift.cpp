#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <titop/graph/linalg/eigen.hpp>

#include "../../examples/scenes/satellite.hpp"
#include "simulation/scenes.hpp"
#include "support/five_masses.hpp"

/// Energy of undamped structures over a million steps. Both rules keep it up to rounding: a step
/// is a product of the state with an orthogonal matrix (in energy's norm), computed to one unit of
/// the last place per state, so that N steps of n states change it by no more than N n 2^-53.

using namespace titop;

namespace {

/// |E/E0 - 1| after so many steps, a trajectory of 10,000 in memory at a time.
double drift(const System& system, Stepper stepper, double h, Eigen::VectorXd x, int steps,
             const std::function<double(const Eigen::VectorXd&)>& energy) {
  const double before = energy(x);
  for (int done = 0; done < steps; done += 10000)
    x = simulate(system, Excitation::none(),
                 {.step = h, .until = 10000 * h, .stepper = stepper, .x0 = x})
            .x;
  return std::abs(energy(x) / before - 1);
}

double bound(int steps, int states) { return steps * (states * 0x1p-53); }

/// Kinetic and potential; a mass moves with the rates of all springs down to the wall.
double energy_of_five(const Eigen::VectorXd& x) {
  constexpr std::array<int, 5> hangs_on{-1, 0, 0, 1, 1};
  std::array<double, 5> velocity{};
  double sum = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    const double stretch = x(2 * static_cast<Eigen::Index>(i));
    const int p = hangs_on[i];
    velocity[i] = x(2 * static_cast<Eigen::Index>(i) + 1) +
                  (p < 0 ? 0 : velocity[static_cast<std::size_t>(p)]);
    sum += titop_test::kMasses[i] * velocity[i] * velocity[i] +
           titop_test::kStiffnesses[i] * stretch * stretch;
  }
  return sum / 2;
}

/// The satellite of the demo, without dampers.
System satellite() {
  const FlexibleBody boom = scenes::read_boom({.kept = 6, .residual = {"P"}});
  return compile(scenes::satellite(boom, nullptr, 0), {.minimize_up_to = 0});
}

/// qdd = -M^-1 K q with the springs' and modes' diagonal K: with q = d y it is ydd = -S y, and
/// twice the energy is y'y + yd' S^-1 yd.
struct Invariant {
  SecondOrder form;
  Eigen::LDLT<Eigen::MatrixXd> inverse;
  explicit Invariant(const StateSpace& m) : form(second_order(m)), inverse(form.S) {}
  double operator()(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd y = form.D_inverse * x(form.q), rate = form.D_inverse * x(form.qdot);
    return y.dot(y) + rate.dot(inverse.solve(rate));
  }
};

}  // namespace

TEST_CASE("energy of the five masses over 1,000,000 steps") {
  const System s =
      compile(titop_test::five_masses_scene(titop_test::kMasses, titop_test::kStiffnesses),
              {.minimize_up_to = 0});
  REQUIRE(s.order() == 10);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(10);
  for (int i = 0; i < 5; ++i) x(2 * i) = i % 2 ? -0.1 : 0.1;
  for (const Stepper stepper : {Stepper::midpoint, Stepper::exact}) {
    CAPTURE(to_string(stepper));
    CHECK(drift(s, stepper, 0.05, x, 1000000, energy_of_five) <= bound(1000000, 10));
  }
}

TEST_CASE("energy of the demo's satellite, undamped, over 1,000,000 steps") {
  const System s = satellite();
  REQUIRE(s.order() == 50);
  StateSpace m;
  s.write(m);
  const Invariant energy(m);
  REQUIRE(energy.form.found);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(50);
  x(energy.form.q) = energy.form.D.diagonal();  // the same energy in every spring and mode
  for (const Stepper stepper : {Stepper::midpoint, Stepper::exact}) {
    CAPTURE(to_string(stepper));
    CHECK(drift(s, stepper, 1e-4, x, 1000000, energy) <= bound(1000000, 50));
  }
}

TEST_CASE("energy of 1000 masses in a row over 10,000 steps, by the midpoint rule") {
  std::vector<double> mass(1000), stiffness(1000);
  for (std::size_t i = 0; i < 1000; ++i) {
    mass[i] = 1 + 0.3 * static_cast<double>(i % 3);
    stiffness[i] = 100 + 7 * static_cast<double>(i % 5);
  }
  const System s = compile(simulation_test::row_of_masses(mass, stiffness));
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2000);
  for (int i = 0; i < 1000; ++i) x(2 * i) = i % 2 ? -0.1 : 0.1;
  const auto energy = [&](const Eigen::VectorXd& at) {
    return simulation_test::energy(mass, stiffness, at);
  };
  CHECK(drift(s, Stepper::midpoint, 0.05, x, 10000, energy) <= bound(10000, 2000));
}
