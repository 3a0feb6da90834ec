#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "control/transfer_functions.hpp"
#include "support/mistakes.hpp"

/// Discrete models, their margins, and delays, against closed forms.

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;
using std::numbers::pi;

namespace {

Complex at(const DiscreteModel& m, double omega) { return m.at(omega)(0, 0); }
bool near(Complex a, Complex b, double tolerance = 1e-13) {
  return std::abs(a - b) <= tolerance * std::abs(b);
}

}  // namespace

TEST_CASE("a lag and a double integrator with the three rules") {
  constexpr double a = 3, h = 0.2;
  const StateSpace lag = ratio({a}, {1, a}), twice = ratio({1}, {1, 0, 0});
  const double e = std::exp(-a * h);
  for (const double w : {0.1, 2.0, 9.0, 15.0}) {
    const Complex z = std::polar(1.0, w * h);
    CHECK(near(at(discretize(lag, h), w), (1 - e) / (z - e)));
    // First-order hold: (z - 1)^2 / (h z) Z{a / (s^2 (s + a))}.
    const Complex ramp = h * z / ((z - 1.0) * (z - 1.0)) - (1 - e) / a * z / ((z - 1.0) * (z - e));
    CHECK(near(at(discretize(lag, h, Discretization::first_order_hold), w),
               (z - 1.0) * (z - 1.0) / (h * z) * ramp));
    const Complex s = 2 / h * (z - 1.0) / (z + 1.0);
    CHECK(near(at(discretize(lag, h, Discretization::tustin), w), a / (s + a)));
    CHECK(near(at(discretize(twice, h), w), h * h / 2.0 * (z + 1.0) / ((z - 1.0) * (z - 1.0))));
    CHECK(near(at(discretize(twice, h, Discretization::first_order_hold), w),
               h * h / 6 * (z * z + 4.0 * z + 1.0) / ((z - 1.0) * (z - 1.0))));
    // Prewarped: equal at its frequency.
    CHECK(near(at(discretize(lag, h, Discretization::tustin, w), w), a / (Complex(0, w) + a)));
  }
}

TEST_CASE("Tustin's rule for modes far above the sample rate") {
  for (const double omega : {1e6, 1e8, 1e11}) {
    constexpr double h = 0.01;
    const StateSpace mode = ratio({omega * omega}, {1, 0.01 * omega, omega * omega});
    for (const double w : {1.0, 100.0}) {
      const Complex s = 2 / h * std::tan(w * h / 2) * Complex(0, 1);
      CHECK(near(at(discretize(mode, h, Discretization::tustin), w),
                 omega * omega / (s * s + 0.01 * omega * s + omega * omega), 1e-12));
    }
  }
}

TEST_CASE("margins of a discrete integrator, of any period") {
  // k h / (z - 1) = at omega: size k h / (2 sin(w h / 2)), angle -90 - w h / 2 degrees.
  for (const double k : {0.5, 2.0})
    for (const double h : {0.01, 0.4}) {
      const Margins m = margins(discretize(ratio({k}, {1, 0}), h));
      CHECK(m.stable);
      CHECK(m.nyquist.agree);
      const LoopMargins& l = m.loops.at(0);
      const double w = 2 / h * std::asin(k * h / 2);
      CHECK(std::abs(l.larger_gain.value / (2 / (k * h)) - 1) <= 1e-9);
      CHECK(std::abs(l.larger_gain.omega / (pi / h) - 1) <= 1e-9);
      CHECK(std::abs(l.phase.value / (pi / 2 - w * h / 2) - 1) <= 1e-9);
      CHECK(std::abs(l.phase.omega / w - 1) <= 1e-9);
      CHECK(std::abs(l.delay.value / ((pi / 2 - w * h / 2) / w) - 1) <= 1e-9);
    }
  const Margins fast = margins(discretize(ratio({30}, {1, 0}), 0.1));  // limit 2 / h
  CHECK(!fast.stable);
  CHECK(fast.nyquist.closed_right == 1);
}

TEST_CASE("a sampled law on a continuous plant") {
  // PD by differences on 1 / s^2: K = kp + kd (z - 1) / (h z), closed-loop stability by Jury is
  // that of the poles of z (z - 1)^2 + (h^2 / 2) (z + 1) (kp z + kd (z - 1) / h).
  constexpr double h = 0.1, kp = 2, kd = 3;
  StateSpace law = ratio({kp + kd / h, -kd / h}, {1, 0});
  const DiscreteModel L = series({law, h}, discretize(ratio({1}, {1, 0, 0}), h));
  for (const double w : {0.3, 4.0, 20.0}) {
    const Complex z = std::polar(1.0, w * h);
    CHECK(near(at(L, w),
               (kp + kd * (z - 1.0) / (h * z)) * (h * h / 2) * (z + 1.0) / ((z - 1.0) * (z - 1.0)),
               1e-12));
  }
  const Margins m = margins(L);
  CHECK(m.stable);
  const LoopMargins& l = m.loops.at(0);
  CHECK(std::abs(std::abs(at(L, l.phase.omega)) - 1) <= 1e-9);
  CHECK(std::abs(std::arg(-at(L, l.phase.omega)) - l.phase.value) <= 1e-9);
  CHECK(std::abs(-1.0 / at(L, l.larger_gain.omega).real() / l.larger_gain.value - 1) <= 1e-9);
  CHECK(std::abs(at(L, l.larger_gain.omega).imag()) <= 1e-9);
}

TEST_CASE("a pole at z = 1 in any coordinates") {
  // L = 1 / s + 1 / (s + 1), held: the closed loop's poles are roots of
  // (z - 1) (z - e) + h (z - e) + (1 - e) (z - 1), e = exp(-h): inside the circle.
  constexpr double h = 0.01;
  const double e = std::exp(-h), q = (-1 - e + h + 1 - e) / 2, p = e - h * e - (1 - e);
  REQUIRE(std::abs(-q + std::sqrt(q * q - p)) < 1);
  StateSpace m;
  m.D = Eigen::MatrixXd::Zero(1, 1);
  double phase = 0;
  for (int k = 0; k < 150; ++k) {
    const Eigen::Matrix2d Q = Eigen::Rotation2Dd(k * 7e-3).toRotationMatrix();
    m.A = Q * Eigen::Vector2d(0, -1).asDiagonal() * Q.transpose();
    m.B = Q * Eigen::Vector2d::Ones(), m.C = Eigen::RowVector2d::Ones() * Q.transpose();
    const Margins found = margins(discretize(m, h));
    CAPTURE(k);
    REQUIRE(found.stable);
    const double angle = found.loops.at(0).phase.value;
    if (k == 0) {
      phase = angle;
      const Complex z = std::polar(1.0, found.loops.at(0).phase.omega * h);
      const Complex L = h / (z - 1.0) + (1 - e) / (z - e);
      CHECK(std::abs(std::abs(L) - 1) <= 1e-9);
      CHECK(std::abs(std::arg(-L) - phase) <= 1e-9);
    }
    CHECK(std::abs(angle / phase - 1) <= 1e-9);
  }
}

TEST_CASE("a closed loop with a pole at z = infinity is not stable") {
  // L = -1 + 1 / (z - 1/4): 1 + L is 0 there.
  StateSpace m;
  m.A = m.B = m.C = Eigen::MatrixXd::Ones(1, 1), m.A(0, 0) = 0.25;
  m.D = -Eigen::MatrixXd::Ones(1, 1);
  for (const double period : {1.0, 0.3, 0.01}) {
    CAPTURE(period);
    bool stable = false;
    try {
      stable = margins(DiscreteModel{m, period}).stable;
    } catch (const Error& error) {
      CHECK(error.has(Code::ill_posed));
    }
    CHECK_FALSE(stable);
  }
}

TEST_CASE("Tustin's rule makes no gain margin of rounding") {
  // L = (0.7 a (s + a) + 1.3) / ((s + a) (s + 2 a)): its phase stays above -180 degrees, and L is 0
  // at z = -1.
  StateSpace m;
  m.B = Eigen::Vector2d(0, 1), m.D = Eigen::MatrixXd::Zero(1, 1);
  for (int k = 1; k < 100; ++k) {
    const double a = 1.48 * k;
    m.A = Eigen::Matrix2d{{-a, 1.3}, {0, -2 * a}}, m.C = Eigen::RowVector2d(1, 0.7 * a);
    const Margins found = margins(discretize(m, 0.01 / std::sqrt(a), Discretization::tustin));
    CAPTURE(a);
    CHECK(found.stable);
    CHECK(std::isinf(found.loops.at(0).larger_gain.value));
  }
}

TEST_CASE("Pade's approximation: all-pass, its phase, and in a diagram") {
  for (int n = 1; n <= 8; ++n) {
    const Lti p = pade(0.3, n);
    const StateSpace m{
        .A = p.A, .B = p.B, .C = p.C, .D = p.D, .states = {}, .inputs = {}, .outputs = {}};
    for (const double x : {0.1, 1.0, 2.5}) {  // omega delay
      const Complex value = m.transfer({0, x / 0.3})(0, 0);
      CHECK(std::abs(std::abs(value) - 1) <= 1e-11);
      // Leading term of the error: (n!)^2 x^(2n+1) / ((2n)! (2n+1)!), times at most 2 for these x.
      const double error = std::exp(2 * std::lgamma(n + 1) - std::lgamma(2 * n + 1) -
                                    std::lgamma(2 * n + 2) + (2 * n + 1) * std::log(x));
      CHECK(std::abs(value - std::polar(1.0, -x)) <= 2 * error + 1e-11);
    }
  }
  const Lti one = pade(0.5, 1);  // (1 - s / 4) / (1 + s / 4)
  CHECK(std::abs(one.A(0, 0) / -4 - 1) <= 1e-15);
  Diagram d{"late"};
  auto u = d.input("u");
  auto late = d.add("late", pade(0.5, 1));
  late.in = u;
  d.output("y") = late.out;
  CHECK(near(compile(d).transfer({0, 2})(0, 0), Complex(1, -0.5) / Complex(1, 0.5)));
}

TEST_CASE("mistakes") {
  const StateSpace lag = ratio({1}, {1, 1});
  CHECK(error_of([&] { discretize(lag, 0); }).has(Code::bad_value));
  CHECK(error_of([&] { discretize(lag, INFINITY); }).has(Code::bad_value));
  CHECK(has_mistake(error_of([&] { discretize(lag, 0.1, Discretization::tustin, 40); }),
                    Code::bad_value, {"40", "31.4159"}));
  CHECK(error_of([&] {
          discretize(lag, 0.1, Discretization::zero_order_hold, 3);
        }).has(Code::bad_value));
  CHECK(error_of([&] {
          discretize(ratio({1}, {1, -20}), 0.1, Discretization::tustin);
        }).has(Code::singular));
  CHECK(error_of([&] { series({lag, 0.1}, {lag, 0.2}); }).has(Code::bad_value));
  StateSpace wide = lag;
  wide.B = MatrixXd::Ones(1, 2), wide.D = MatrixXd::Zero(1, 2);
  CHECK(error_of([&] { series({lag, 0.1}, {wide, 0.1}); }).has(Code::size));
  CHECK(error_of([&] { margins(DiscreteModel{ratio({1}, {1, 1}), 0.1}); }).has(Code::singular));
  CHECK(error_of([&] { pade(0, 2); }).has(Code::bad_value));
  CHECK(error_of([&] { pade(0.1, 11); }).has(Code::bad_value));
}
