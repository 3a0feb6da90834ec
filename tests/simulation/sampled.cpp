#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "scenes.hpp"
#include "support/mistakes.hpp"

/// A discrete law in the loop, against recursions by hand.

using namespace titop;
using namespace simulation_test;
using titop_test::error_of;

namespace {

StateSpace law_of(Eigen::MatrixXd A, Eigen::MatrixXd B, Eigen::MatrixXd C, Eigen::MatrixXd D,
                  std::vector<std::string> from, std::vector<std::string> to) {
  StateSpace law{std::move(A), std::move(B),    std::move(C), std::move(D),
                 {},           std::move(from), std::move(to)};
  for (Eigen::Index i = 0; i < law.A.rows(); ++i) law.states.push_back("x" + std::to_string(i));
  return law;
}

StateSpace gain(double k, const char* from = "y", const char* to = "u") {
  return law_of(Eigen::MatrixXd(0, 0), Eigen::MatrixXd(0, 1), Eigen::MatrixXd(1, 0),
                Eigen::MatrixXd::Constant(1, 1, k), {from}, {to});
}

/// y' = u + w.
System integrator() {
  Diagram d{"integrator"};
  auto x = d.add("x", Integrator{});
  x.in = d.input("u") + d.input("w");
  d.output("y") = x.out;
  return compile(d);
}

/// y'' = u: outputs y and y'.
System free_mass() {
  Diagram d{"mass"};
  auto v = d.add("v", Integrator{}), x = d.add("x", Integrator{});
  v.in = d.input("u");
  x.in = v.out;
  d.output("y") = x.out;
  d.output("rate") = v.out;
  return compile(d);
}

}  // namespace

TEST_CASE("a sampled gain on an integrator: (1 - K T)^k at the samples, lines in between") {
  const double K = 1.2, T = 0.5;
  const System s = integrator();
  for (const Stepper stepper : {Stepper::exact, Stepper::midpoint, Stepper::automatic}) {
    CAPTURE(to_string(stepper));
    const Trajectory t =
        simulate(s, Excitation::sampled({gain(-K), T}),
                 {.step = T / 4, .until = 10, .stepper = stepper, .x0 = Eigen::VectorXd::Ones(1)});
    REQUIRE(t.y.cols() == 81);
    for (int i = 0; i < t.y.cols(); ++i) {
      const double at_sample = std::pow(1 - K * T, i / 4);
      CHECK(std::abs(t.y(0, i) - at_sample * (1 - K * T * (i % 4) / 4)) <= 1e-14);
    }
  }
}

TEST_CASE("another excitation beside the law: an integrator under a constant push") {
  const double K = 0.8, T = 0.25;
  const Trajectory t = simulate(
      integrator(), Excitation::sampled({gain(-K), T}, Excitation::step(Eigen::Vector2d(0, 3))),
      {.step = T, .until = 20});
  double y = 0;
  for (int i = 0; i < t.y.cols(); ++i, y += T * (3 - K * y))
    CHECK(std::abs(t.y(0, i) - y) <= 1e-13);
}

TEST_CASE("a law with states on a free mass: the recursion of both, by hand") {
  // The derivative of a filtered position, one period late.
  const double T = 0.125;
  Eigen::Matrix2d A;
  A << 0.5, 0, 1, 0;
  const Eigen::Vector2d B(0.5, 0);
  const Eigen::RowVector2d C(-2.5, 1.25);
  const StateSpace law = law_of(A, B, C, Eigen::MatrixXd::Constant(1, 1, -0.5), {"y"}, {"u"});
  const Trajectory t = simulate(free_mass(), Excitation::sampled({law, T}),
                                {.step = T / 2, .until = 10, .x0 = Eigen::Vector2d(0.25, 1)});
  // States of the system by name: v, x or x, v, as declared.
  const bool rate_first = t.states.front().starts_with("v");
  double x = rate_first ? 1 : 0.25, v = rate_first ? 0.25 : 1;
  Eigen::Vector2d own(0, 0);
  for (int i = 0; i < t.y.cols(); i += 2) {
    CHECK(std::abs(t.y(0, i) - x) <= 1e-12);
    CHECK(std::abs(t.y(1, i) - v) <= 1e-12);
    const double u = C.dot(own) - 0.5 * x;
    own = (A * own + B * x).eval();
    x += T * v + T * T / 2 * u;
    v += T * u;
  }
}

TEST_CASE("a reference beside the law: a jump at a sample is seen at once") {
  // e = r - y reaches the law; y' = u.
  Diagram d{"reference"};
  auto x = d.add("x", Integrator{});
  auto r = d.input("r");
  x.in = d.input("u");
  d.output("e") = r - x.out;
  d.output("y") = x.out;
  const double K = 0.5, T = 1;
  const Eigen::RowVector4d held(1, -2, 4, 0.5);
  Eigen::MatrixXd samples = Eigen::MatrixXd::Zero(2, 4);
  const System s = compile(d);
  samples.row(s.inputs().front() == "r" ? 0 : 1) = held;
  const Trajectory t =
      simulate(s, Excitation::sampled({gain(K, "e"), T}, Excitation::held(samples, T)),
               {.step = T / 4, .until = 4});
  double y = 0;
  for (int k = 0; k < 4; ++k) {
    CHECK(std::abs(t.y(1, 4 * k) - y) <= 1e-14);
    y += T * K * (held(k) - y);
  }
  CHECK(std::abs(t.y(1, 16) - y) <= 1e-14);
}

TEST_CASE("an unstable plant that the law stabilises: the estimated error stays that of the loop") {
  // y'' = y + u under a sampled PD law, by the recursion of the plant, e^T by hand.
  const double T = 0.1, kp = 3, kd = 2;
  Diagram d{"pendulum"};
  auto v = d.add("v", Integrator{}), x = d.add("x", Integrator{});
  v.in = x.out + d.input("u");
  x.in = v.out;
  d.output("y") = x.out;
  d.output("rate") = v.out;
  const System s = compile(d);
  const StateSpace law = law_of(Eigen::MatrixXd(0, 0), Eigen::MatrixXd(0, 2), Eigen::MatrixXd(1, 0),
                                Eigen::RowVector2d(-kp, -kd), {"y", "rate"}, {"u"});
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(2);
  x0(s.states().front().starts_with("v") ? 1 : 0) = 1;
  for (const Stepper stepper : {Stepper::automatic, Stepper::exact}) {
    const Trajectory t = simulate(s, Excitation::sampled({law, T}),
                                  {.step = T / 2, .until = 100, .stepper = stepper, .x0 = x0});
    REQUIRE(t.error.size() == 2);
    CHECK(t.error.maxCoeff() < 1e-9);
    double y = 1, rate = 0;
    for (int k = 0; k < 50; ++k) {
      CHECK(std::abs(t.y(0, 2 * k) - y) <= 1e-12);
      const double u = -kp * y - kd * rate, c = std::cosh(T), h = std::sinh(T);
      const double next = c * y + h * rate + (c - 1) * u;
      rate = h * y + c * rate + h * u;
      y = next;
    }
  }
  const Trajectory coarse =
      simulate(s, Excitation::sampled({law, T}),
               {.step = T / 2, .until = 20, .stepper = Stepper::midpoint, .x0 = x0});
  CHECK(std::abs(coarse.y(0, Eigen::last)) < 1e-3);
}

TEST_CASE("a law that does not fit is refused, with the names that do") {
  const System s = integrator();
  const auto code = [](auto f) { return error_of(f).mistakes().front().code; };
  const auto run = [&](const Excitation& e) {
    return code([&] { simulate(s, e, {.step = 0.1, .until = 1}); });
  };
  CHECK(run(Excitation::sampled({gain(1, "z"), 0.1})) == Code::unknown_name);
  CHECK(run(Excitation::sampled({gain(1, "y", "v"), 0.1})) == Code::unknown_name);
  CHECK(run(Excitation::sampled({gain(1), 0.25})) == Code::bad_value);
  CHECK(run(Excitation::sampled({gain(1), 0.05})) == Code::bad_value);
  CHECK(code([] { Excitation::sampled({gain(1), 0}); }) == Code::bad_value);
  CHECK(code([] { Excitation::sampled({gain(std::nan("")), 0.1}); }) == Code::not_finite);
  CHECK(code([] {
          Excitation::sampled({gain(1), 0.1}, Excitation::sampled({gain(1), 0.1}));
        }) == Code::bad_value);
  StateSpace nameless = gain(1);
  nameless.inputs.clear();
  CHECK(code([&] { Excitation::sampled({nameless, 0.1}); }) == Code::size);
}
