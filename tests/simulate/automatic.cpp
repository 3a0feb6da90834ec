#include <doctest/doctest.h>

#include <cmath>

#include "simulate/scenes.hpp"

/// The stepper that is chosen where none is asked for says how good it is.

using namespace titop;
using namespace simulate_test;

namespace {

/// n masses of 1 kg in a row on springs of 100 N/m, a force on the last.
System row_of(int n) {
  std::vector<double> mass(static_cast<std::size_t>(n), 1.0), stiffness(mass.size(), 100.0);
  return compile(row_of_masses(mass, stiffness));
}

}  // namespace

TEST_CASE("up to 600 states the choice is exact, and its error is 0") {
  const System s = row_of(300);
  const Trajectory t =
      simulate(s, Excitation::step(Eigen::VectorXd::Ones(1)), {.step = 0.5, .until = 1});
  CHECK(t.stepper == Stepper::exact);
  CHECK(t.error == Eigen::VectorXd::Zero(300));
}

TEST_CASE(
    "beyond, midpoint at half the step: the error is told, and is about three times the true one") {
  const System s = row_of(310);
  const Excitation push =
      Excitation::function([](double time) { return Eigen::VectorXd::Constant(1, 1 + time); });
  // Far from the push nothing has arrived by then: of that, no digit is right.
  const Trajectory t = simulate(s, push, {.step = 0.01, .until = 2, .accuracy = HUGE_VAL});
  CHECK(t.stepper == Stepper::midpoint);
  const Trajectory half =
      simulate(s, push, {.step = 0.005, .until = 2, .stepper = Stepper::midpoint});
  const Trajectory exact = simulate(s, push, {.step = 0.01, .until = 2, .stepper = Stepper::exact});
  CHECK(half.error.size() == 0);
  const Eigen::Index last = 309;  // of the mass that is pushed
  double off = 0, size = 0;
  for (Eigen::Index k = 0; k <= 200; ++k) {
    CHECK(std::abs(t.y(last, k) - half.y(last, 2 * k)) <= 1e-12 * std::abs(half.y(last, 2 * k)));
    off = std::max(off, std::abs(t.y(last, k) - exact.y(last, k)));
    size = std::max(size, std::abs(exact.y(last, k)));
  }
  CHECK(t.error(last) >= 2.5 * off / size);  // h^2: (4 - 1) times
  CHECK(t.error(last) <= 3.5 * off / size);
}

TEST_CASE("beyond, steps that are too long are refused, with the output and the way out") {
  const System s = row_of(310);
  const Excitation push = Excitation::step(Eigen::VectorXd::Ones(1));
  try {
    simulate(s, push, {.step = 1, .until = 10});
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.has(Code::bad_value));
    const std::string text = error.what();
    CHECK(text.find("half of the step of 1 s changes output s") != std::string::npos);
    CHECK(text.find("Stepper::exact") != std::string::npos);
  }
  const Trajectory t = simulate(s, push, {.step = 1, .until = 10, .accuracy = HUGE_VAL});
  CHECK(t.error.maxCoeff() > 0.01);
}
