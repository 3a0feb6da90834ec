#include <doctest/doctest.h>

#include <cmath>
#include <titop/graph/linalg/eigen.hpp>

#include "scenes.hpp"

/// Stepper::exact against motions in closed form: no step is too long.

using namespace titop;
using namespace simulation_test;

namespace {

Eigen::VectorXd one(double x) { return Eigen::VectorXd::Constant(1, x); }

/// Largest difference of the output from the formula, over the formula's largest value.
template <class Formula>
double off(const Trajectory& t, Formula formula) {
  double worst = 0, largest = 0;
  for (std::size_t k = 0; k < t.time.size(); ++k) {
    const double x = formula(t.time[k]);
    worst = std::max(worst, std::abs(t.y(0, static_cast<Eigen::Index>(k)) - x));
    largest = std::max(largest, std::abs(x));
  }
  return worst / largest;
}

}  // namespace

TEST_CASE("exact: a step force on an undamped mass, with steps from a hundredth to ten periods") {
  const double m = 2, k = 18, omega = 3;
  const System s = compile(mass_on_spring(m, k, 0));
  for (const double h : {0.02, 0.5, 2.0, 20.0}) {
    CAPTURE(h);
    const Trajectory t = simulate(s, Excitation::step(one(9)), {.step = h, .until = 40});
    CHECK(t.stepper == Stepper::exact);
    CHECK(t.time.size() == static_cast<std::size_t>(std::lround(40 / h)) + 1);
    CHECK(off(t, [&](double time) { return 9 / k * (1 - std::cos(omega * time)); }) <= 1e-12);
  }
}

TEST_CASE("exact: a damped mass from where it was let go") {
  const double m = 2, k = 18, c = 1.2, sigma = c / (2 * m), w = std::sqrt(k / m - sigma * sigma);
  const System s = compile(mass_on_spring(m, k, c));
  const Trajectory t =
      simulate(s, Excitation::none(), {.step = 0.25, .until = 20, .x0 = Eigen::Vector2d(0.1, 0)});
  CHECK(off(t, [&](double time) {
          return 0.1 * std::exp(-sigma * time) *
                 (std::cos(w * time) + sigma / w * std::sin(w * time));
        }) <= 1e-13);
}

TEST_CASE("exact: ramps, samples and records are taken as they are") {
  const double m = 2, k = 18, omega = 3;
  const System s = compile(mass_on_spring(m, k, 0));
  // u = t: x = (t - sin(omega t) / omega) / k
  const auto ramp = [&](double t) { return (t - std::sin(omega * t) / omega) / k; };
  const auto step = [&](double t) { return t < 0 ? 0 : (1 - std::cos(omega * t)) / k; };
  CHECK(off(simulate(s, Excitation::function([](double t) { return one(t); }),
                     {.step = 0.5, .until = 6}),
            ramp) <= 1e-13);
  Eigen::MatrixXd record(1, 2);
  record << 0, 6;
  CHECK(off(simulate(s, Excitation::recorded({0, 6}, record), {.step = 0.5, .until = 6}), ramp) <=
        1e-13);
  // 1 until 0.6 s, then 3: by samples, and by a record that jumps.
  const auto jump = [&](double t) { return step(t) + 2 * step(t - 0.6); };
  Eigen::MatrixXd samples(1, 4);
  samples << 1, 1, 3, 3;
  CHECK(off(simulate(s, Excitation::held(samples, 0.3), {.step = 0.1, .until = 1.8}), jump) <=
        1e-13);
  CHECK(
      off(simulate(s, Excitation::recorded({0, 0.6, 0.6, 2}, samples), {.step = 0.1, .until = 1.8}),
          jump) <= 1e-13);
}

TEST_CASE("exact: a record may jump where a step ends, however many steps there have been") {
  Eigen::MatrixXd record(1, 4);
  record << 1, 1, 3, 3;
  // Products of a step and a number of steps miss such a time by their rounding.
  for (const double h : {1e-4, 0.3, 7e-7})
    for (const int steps : {3, 15001000, 99999997, 900000001}) {
      const double jump = std::nextafter(steps * h, 0.0);
      for (const double time : {jump, steps * h, std::nextafter(steps * h, HUGE_VAL)}) {
        const Excitation u = Excitation::recorded({0, time, time, 2e9}, record);
        CHECK(u((steps - 1) * h, steps * h).second(0) == 1);
        CHECK(u(steps * h, (steps + 1) * h).first(0) == 3);
      }
    }
}

TEST_CASE("exact: a sample belongs to its own period, however many there have been") {
  Eigen::MatrixXd samples = Eigen::MatrixXd::Zero(1, 2);
  samples << 1, 3;
  const Excitation u = Excitation::held(samples, 1e8);
  CHECK(u(0, 1e8).second(0) == 1);
  CHECK(u(1e8, 1.5e8).first(0) == 3);
  CHECK_THROWS_AS(Excitation::held(samples, 1)(1e9 - 0.25, 1e9 + 0.25), Error);
}

TEST_CASE("exact: six masses between two walls move as their modes; the tied stretch follows") {
  const std::vector<double> m{1.3, 0.7, 1.9, 0.5, 1.1, 0.9}, k{61, 97, 55, 83, 71, 66};
  Diagram d{"between walls"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  for (std::size_t i = 0; i < 6; ++i) {
    z.push_back(d.add(fmt::format("z{}", i + 1), SpringMass{.mass = m[i], .stiffness = k[i]}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z[i], z[i - 1].child);
  }
  z.back().child.accel = 0;  // the other wall
  z[2].child.force += u;
  d.output("x3") = z[0].stretch + z[1].stretch + z[2].stretch;
  const System s = compile(d);
  REQUIRE(s.order() == 10);
  // By hand: the five remaining masses move, M xdd + K x = F e_3; the sixth is fixed to the wall.
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(5, 5), K = M;
  for (int i = 0; i < 5; ++i) {
    M(i, i) = m[static_cast<std::size_t>(i)];
    K(i, i) = k[static_cast<std::size_t>(i)] + k[static_cast<std::size_t>(i) + 1];
    if (i > 0) K(i, i - 1) = K(i - 1, i) = -k[static_cast<std::size_t>(i)];
  }
  const Eigen::MatrixXd root = M.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(root * K * root);
  const Eigen::VectorXd phi = (root * modes.eigenvectors()).row(2);
  const auto x3 = [&](double t) {
    double x = 0;
    for (int j = 0; j < 5; ++j)
      x += phi(j) * phi(j) / modes.eigenvalues()(j) *
           (1 - std::cos(std::sqrt(modes.eigenvalues()(j)) * t));
    return x;
  };
  CHECK(off(simulate(s, Excitation::step(one(1)), {.step = 0.1, .until = 30}), x3) <= 1e-11);
  // The same by the midpoint rule, whose error is of second order.
  const auto midpoint = [&](double h) {
    return off(simulate(s, Excitation::step(one(1)),
                        {.step = h, .until = 3, .stepper = Stepper::midpoint}),
               x3);
  };
  CHECK(std::abs(midpoint(2e-3) / midpoint(1e-3) - 4) <= 0.05);
}
