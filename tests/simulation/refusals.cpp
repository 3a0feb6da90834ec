#include <doctest/doctest.h>

#include <limits>

#include "scenes.hpp"
#include "support/mistakes.hpp"

/// Senseless input is refused, with the way out.

using namespace titop;
using namespace simulation_test;
using titop_test::error_of;
using titop_test::says;

namespace {

const System& plant() {
  static const System s = compile(mass_on_spring(2, 18, 0.1));
  return s;
}

Error refused(const Excitation& e, const Simulation& s) {
  return error_of([&] { simulate(plant(), e, s); });
}

}  // namespace

TEST_CASE("refused: steps, ends and states that do not fit") {
  const Excitation none = Excitation::none();
  CHECK(
      says(refused(none, {.step = 0, .until = 1}), Code::bad_value, {"Simulation", "0 s", "1 s"}));
  CHECK(says(refused(none, {.step = -0.1, .until = 1}), Code::bad_value,
             {"Simulation", "-0.1 s", "1 s"}));
  CHECK(says(refused(none, {.step = 0.3, .until = 1}), Code::bad_value,
             {"Simulation", "0.3 s", "1 s"}));
  CHECK(says(refused(none, {.step = 1e-10, .until = 1}), Code::bad_value,
             {"Simulation", "1e-10 s", "1e9"}));
  CHECK(says(refused(none, {.step = 0.1, .until = 1, .x0 = Eigen::Vector3d(1, 2, 3)}), Code::size,
             {"Simulation::x0", "3", "mass on a spring", "2"}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(says(refused(none, {.step = 0.1, .until = 1, .x0 = Eigen::Vector2d(nan, 0)}),
             Code::not_finite, {"Simulation::x0"}));
}

TEST_CASE("refused: inputs of another number, jumps inside a step, records that go back") {
  const Simulation s{.step = 0.1, .until = 1};
  CHECK(says(refused(Excitation::step(Eigen::Vector2d(1, 2)), s), Code::size,
             {"2 inputs", "0 s", "mass on a spring", "1"}));
  CHECK(says(refused(Excitation::held(Eigen::MatrixXd::Ones(1, 3), 0.25), s), Code::bad_value,
             {"0.2", "0.25 s"}));
  Eigen::MatrixXd jump(1, 4);
  jump << 0, 0, 1, 1;
  CHECK(says(refused(Excitation::recorded({0, 0.55, 0.55, 1}, jump), s), Code::bad_value,
             {"0.55 s"}));
  CHECK(says(error_of([&] {
               Excitation::recorded({0, 1, 0.5, 2}, jump);
             }),
             Code::bad_value, {"Excitation::recorded", "time 3", "0.5"}));
  CHECK(says(error_of([&] {
               Excitation::recorded({0, 1}, jump);
             }),
             Code::size, {"Excitation::recorded", "2", "4"}));
  CHECK(says(error_of([&] { Excitation::held(jump, 0); }), Code::bad_value,
             {"Excitation::held", "0 s"}));
  CHECK(says(error_of([&] { Excitation::held(Eigen::MatrixXd(1, 0), 1); }), Code::size,
             {"Excitation::held"}));
}

TEST_CASE("refused: an overflowing response, with the time") {
  Diagram d{"runaway"};
  auto u = d.input("u");
  auto a = d.add("a", Lti{.A = Eigen::MatrixXd::Constant(1, 1, 50.0),
                          .B = Eigen::MatrixXd::Ones(1, 1),
                          .C = Eigen::MatrixXd::Ones(1, 1),
                          .D = Eigen::MatrixXd::Zero(1, 1)});
  a.in = u;
  d.output("y") = a.out;
  const Error text = error_of([&] {
    simulate(compile(d), Excitation::step(Eigen::VectorXd::Ones(1)), {.step = 1, .until = 100});
  });
  CHECK(says(text, Code::not_finite, {"runaway", "15 s"}));  // e^709 is the largest double
}
