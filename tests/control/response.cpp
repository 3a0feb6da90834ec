#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

/// Responses in dB and degrees, and inputs by name.

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;

namespace {

/// y = 1 / (s + 2)^3 of u, z = 3 v.
System three_lags() {
  Diagram d{"three lags"};
  auto u = d.input("u"), v = d.input("v", 3);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  const Lti lag{.A = -2 * one, .B = one, .C = one};
  auto a = d.add("a", lag), b = d.add("b", lag), c = d.add("c", lag);
  a.in = u, b.in = a.out, c.in = b.out;
  d.output("y") = c.out;
  d.output("z", 3) = 3.0 * v;
  return compile(d);
}

}  // namespace

TEST_CASE("three lags: from 0 to -270 degrees without a jump") {
  const System system = three_lags();
  const std::vector<double> omega{1e-3, 0.5, 2, 2 * std::sqrt(3.0), 20, 2e4};
  const BodeResponse r = bode(system, "y", "u", omega);
  CHECK(r.omega == omega);
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const double w = omega[i];
    CHECK(std::abs(r.degrees[i] + 3 * degrees(std::atan(w / 2))) <= 1e-9);
    CHECK(std::abs(r.decibels[i] + 30 * std::log10(4 + w * w)) <= 1e-10);
  }
  CHECK(std::abs(bode(system, "z(2)", "v(2)", omega).decibels[0] - decibels(3)) <= 1e-12);
  CHECK(has_mistake(error_of([&] { bode(system, "x", "u", omega); }), Code::unknown_name,
                    {"output", "x", "y", "z(1)"}));
  CHECK(has_mistake(error_of([&] { bode(system, "y", "w", omega); }), Code::unknown_name,
                    {"input", "w", "u", "v(1)"}));
}

TEST_CASE("angles of an undamped mode, of zeros and of poles") {
  const std::vector<Complex> values{1, -1, 0, {INFINITY, 0}, {0, -2}, {0, 2}};
  const std::vector<double> d = degrees(values);
  CHECK(d[0] == 0);
  CHECK(d[1] == -180);
  CHECK(std::isnan(d[2]));
  CHECK(std::isnan(d[3]));
  CHECK(d[4] == -90);
  CHECK(d[5] == 90);
  CHECK(std::abs(decibels(values)[4] / (20 * std::log10(2.0)) - 1) <= 1e-15);
}

TEST_CASE("angles of an undamped mode's rate, and of its acceleration with any damping") {
  // From force to rate, s / (s^2 + 1): passive, from 90 to -90.
  const auto angles = [](double damping, int power) {
    std::vector<Complex> values;
    for (const double w : {0.1, 0.4, 0.9, 1.2, 30.0}) {
      const Complex s(0, w);
      values.push_back(std::pow(s, power) / (s * s + damping * s + 1.0));
    }
    return degrees(values);
  };
  CHECK(angles(0, 1) == std::vector<double>{90, 90, 90, -90, -90});
  for (const double damping : {1e-6, 1e-3, 0.1}) {
    const std::vector<double> rate = angles(damping, 1), acceleration = angles(damping, 2);
    CHECK(std::abs(rate[0] - 90) <= 0.1 * 90 * damping + 1e-9);
    CHECK(std::abs(rate[4] + 90) <= 3 * damping);
    // From 180 = -180 down: each pole turns the angle by -180 between its ends.
    CHECK(std::abs(acceleration[0] + 180) <= 6 * damping + 1e-9);
    CHECK(std::abs(acceleration[4] + 360) <= 3 * damping);
    for (std::size_t i = 1; i < 5; ++i) CHECK(acceleration[i] < acceleration[i - 1]);
  }
}

TEST_CASE("inputs by name, and a step of them") {
  const System system = three_lags();
  CHECK(system.input("v(3)") == 3);
  CHECK(system.output("z(2)") == 2);
  CHECK(
      has_mistake(error_of([&] { system.output("v(2)"); }), Code::unknown_name, {"v(2)", "z(3)"}));
  CHECK(has_mistake(error_of([&] { system.input("v"); }), Code::unknown_name, {"v", "v(2)"}));
  CHECK(input_values(system, {{"v(3)", 0.5}, {"u", 2}}) == Eigen::Vector4d(2, 0, 0, 0.5));
  CHECK(input_values(system, {}) == Eigen::Vector4d::Zero());
  CHECK(has_mistake(error_of([&] {
                      input_values(system, {{"v", 1}});
                    }),
                    Code::unknown_name, {"v", "v(2)"}));
  CHECK(has_mistake(error_of([&] {
                      input_values(system, {{"u", 1}, {"u", 1}});
                    }),
                    Code::duplicate_name, {"u"}));
  const Trajectory t = simulate(system, Excitation::step(input_values(system, {{"v(2)", 4}})),
                                {.step = 0.1, .until = 0.2});
  CHECK(t.y.col(1).tail(3) == Eigen::Vector3d(0, 12, 0));
}
