#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <titop/titop.hpp>

#include "control/transfer_functions.hpp"
#include "support/mistakes.hpp"

/// Margins of textbook loops against closed forms: some fifty loops.

using namespace titop;
using namespace titop_test;
using std::numbers::pi;

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kClose = 1e-9;

bool close(const MarginAt& m, double value, double omega) {
  const bool right = std::isinf(value) ? m.value == value : std::abs(m.value / value - 1) <= kClose;
  return right &&
         (std::isnan(omega) || m.omega == omega || std::abs(m.omega - omega) <= kClose * omega);
}

LoopMargins one(const StateSpace& L, double delay = 0) {
  const Margins m = margins(L, {.delay = delay});
  CHECK(m.stable);
  CHECK(m.nyquist.agree);
  REQUIRE(m.loops.size() == 1);
  return m.loops[0];
}

}  // namespace

TEST_CASE("an integrator: only its phase margin is finite") {
  for (const double k : {1e-3, 0.7, 1.0, 40.0}) {
    const LoopMargins m = one(ratio({k}, {1, 0}));
    CHECK(m.larger_gain.value == kNone);
    CHECK(m.smaller_gain.value == 0);
    CHECK(close(m.phase, pi / 2, k));
    CHECK(close(m.delay, pi / 2 / k, k));
    CHECK(close(m.nearest, 1, NAN));
    CHECK(std::abs(m.disk.alpha - 2) <= kClose);
  }
}

TEST_CASE("an integrator with an exact delay") {
  for (const double k : {0.2, 1.0, 3.0})
    for (const double tau : {0.05, 0.3, 0.45}) {
      CAPTURE(k);
      CAPTURE(tau);
      const LoopMargins m = one(ratio({k}, {1, 0}), tau);
      CHECK(close(m.larger_gain, pi / 2 / (k * tau), pi / 2 / tau));
      CHECK(m.smaller_gain.value == 0);
      CHECK(close(m.phase, pi / 2 - k * tau, k));
      CHECK(close(m.delay, pi / 2 / k - tau, k));
    }
  const Margins late = margins(ratio({1}, {1, 0}), {.delay = 1.7});  // above pi / 2
  CHECK(!late.stable);
  CHECK(late.nyquist.closed_right == 2);
  CHECK(late.nyquist.encirclements == 2);
}

TEST_CASE("the second-order standard loop: w^2 / (s (s + 2 z w))") {
  for (const double z : {0.05, 0.3, 0.7, 1.0, 2.0})
    for (const double w : {0.01, 1.0, 300.0}) {
      const LoopMargins m = one(ratio({w * w}, {1, 2 * z * w, 0}));
      const double crossing = std::sqrt(std::sqrt(1 + 4 * z * z * z * z) - 2 * z * z);
      CHECK(m.larger_gain.value == kNone);
      CHECK(close(m.phase, std::atan(2 * z / crossing), w * crossing));
      CHECK(close(m.delay, std::atan(2 * z / crossing) / (w * crossing), w * crossing));
    }
}

TEST_CASE("three lags and an integrator with two: the gain margin of Routh") {
  for (const double k : {0.1, 1.0, 7.9}) {
    const double a = 1.3, at = std::sqrt(3.0) * a;
    const LoopMargins m = one(ratio({k * a * a * a}, {1, 3 * a, 3 * a * a, a * a * a}));
    CHECK(close(m.larger_gain, 8 / k, at));
    if (k > 1) {
      const double w = a * std::sqrt(std::pow(k, 2.0 / 3) - 1);
      CHECK(close(m.phase, pi - 3 * std::atan(w / a), w));
    } else {
      CHECK(m.phase.value == kNone);  // k = 1: |L| is 1 at 0 alone
    }
  }
  for (const double a : {0.5, 2.0})
    for (const double b : {1.0, 30.0}) {
      const double limit = a * b * (a + b), k = limit / 5;
      const LoopMargins m = one(ratio({k}, {1, a + b, a * b, 0}));
      CHECK(close(m.larger_gain, 5, std::sqrt(a * b)));
    }
}

TEST_CASE("a double integrator with a PD law") {
  for (const double k : {0.04, 1.0, 25.0})
    for (const double T : {0.2, 1.5, 6.0}) {
      const LoopMargins m = one(ratio({k * T, k}, {1, 0, 0}));
      const double t = k * T * T, w = std::sqrt(k * (t + std::sqrt(t * t + 4)) / 2);
      CHECK(m.larger_gain.value == kNone);
      CHECK(m.smaller_gain.value == 0);
      CHECK(close(m.phase, std::atan(T * w), w));
      CHECK(close(m.delay, std::atan(T * w) / w, w));
      // |S|^2 = w^4 / ((k - w^2)^2 + (k T w)^2): largest at w^2 = 2 k / (2 - t), if t < 2.
      if (t < 2)
        CHECK(close(m.nearest, std::sqrt(t * (1 - t / 4)), std::sqrt(2 * k / (2 - t))));
      else
        CHECK(close(m.nearest, 1, NAN));
    }
}

TEST_CASE("an unstable plant: the gain may also become too small") {
  for (const double a : {0.1, 2.0})
    for (const double k : {1.2, 3.0, 50.0}) {
      const LoopMargins m = one(ratio({k * a}, {1, -a}));
      const double w = a * std::sqrt(k * k - 1);
      CHECK(close(m.smaller_gain, 1 / k, 0));
      CHECK(m.larger_gain.value == kNone);
      CHECK(close(m.phase, std::acos(1 / k), w));
      CHECK(std::abs(m.disk.alpha / (2 * (k - 1) / (k + 1)) - 1) <= kClose);
      CHECK(std::abs(m.disk.least_gain() - 1 / k) <= kClose);  // both are reached at 0
    }
  // k (s + 1) / (s (s - 1)): stable for k > 1, phase crossing at 1 with |L| = k.
  const LoopMargins m = one(ratio({3, 3}, {1, -1, 0}));
  CHECK(close(m.smaller_gain, 1.0 / 3, 1));
}

TEST_CASE("a conditionally stable loop: both gain margins") {
  // k (s + 1)^2 / s^3 is stable for k > 1/2; with lags (s / 20 + 1)^2 also below an upper limit.
  const LoopMargins m = one(ratio({1, 2, 1}, {1, 0, 0, 0}));
  CHECK(close(m.smaller_gain, 0.5, 1));
  CHECK(m.larger_gain.value == kNone);
  const double T = 0.05;  // Im = 0: 2 atan w - 2 atan(w T) = pi / 2
  const double root = std::sqrt((1 - T) * (1 - T) - 4 * T);
  const double slow = ((1 - T) - root) / (2 * T), fast = ((1 - T) + root) / (2 * T);
  const auto size = [&](double w) { return (1 + w * w) / (w * w * w * (1 + T * T * w * w)); };
  const LoopMargins l = one(ratio({1, 2, 1}, {T * T, 2 * T, 1, 0, 0, 0}));
  CHECK(close(l.smaller_gain, 1 / size(slow), slow));
  CHECK(close(l.larger_gain, 1 / size(fast), fast));
}

TEST_CASE("a delayed lag that is nearest to -1 at rest") {
  // L = -k / (s + 1): |1 + L| = 1 - k and |1 - L| = 1 + k at 0, and more than the one, less than
  // the other above it.
  for (const double k : {0.5, 0.9, 0.999})
    for (const double tau : {1e-3, 1e-2, 1.0}) {
      CAPTURE(k);
      CAPTURE(tau);
      const LoopMargins m = one(ratio({-k}, {1, 1}), tau);
      CHECK(std::abs(m.nearest.value / (1 - k) - 1) <= 1e-12);
      CHECK(m.nearest.omega == 0);
      CHECK(std::abs(m.disk.alpha / (2 * (1 - k) / (1 + k)) - 1) <= 1e-12);
    }
}

TEST_CASE("an integrator with a lag and a delay, the lag from slower to far faster") {
  for (const double a : {0.3, 3.0, 30.0, 300.0, 2000.0, 1e4, 1e6})
    for (const double k : {0.5, 3.0}) {
      const double tau = 0.1;
      if (k > 1 && a < 1) continue;
      CAPTURE(a);
      CAPTURE(k);
      // k a / (s (s + a)) e^(-s tau) is real and negative where atan(w / a) + w tau = pi / 2.
      double low = 0, high = pi / 2 / tau;
      for (int i = 0; i < 200; ++i)
        (std::atan((low + high) / 2 / a) + (low + high) / 2 * tau < pi / 2 ? low : high) =
            (low + high) / 2;
      const LoopMargins m = one(ratio({k * a}, {1, a, 0}), tau);
      CHECK(close(m.larger_gain, low * std::hypot(low, a) / (k * a), low));
      const double w = std::sqrt(2.0) * k / std::sqrt(1 + std::sqrt(1 + 4 * k * k / (a * a)));
      CHECK(close(m.phase, pi / 2 - std::atan(w / a) - w * tau, w));
      CHECK(close(m.delay, (pi / 2 - std::atan(w / a)) / w - tau, w));
    }
}

TEST_CASE(
    "a double integrator, a PD law, a filter of damping sqrt(1/2), a delay: no smaller gain") {
  for (int i = 0; i < 60; ++i) {
    const double w = 2 * std::pow(1.1, i), zeta = i % 2 ? std::sqrt(0.5) : 0.5;
    CAPTURE(w);
    // (s + 0.25) w^2 / (s^2 (s^2 + 2 zeta w s + w^2)): below -180 deg from a frequency on only.
    const LoopMargins m = one(ratio({w * w, 0.25 * w * w}, {1, 2 * zeta * w, w * w, 0, 0}), 0.05);
    CHECK(m.smaller_gain.value == 0);
    CHECK(m.larger_gain.value > 1);
  }
}

TEST_CASE("closed-loop poles of a loop with a delay near zeros of L beside a pole on the axis") {
  // L = 100 (s^2 - 0.18 s + 0.81) / (s (s^2 + 1)): of the zeros, right of the axis, closed-loop
  // poles are near. L = 20 (s + 1)^2 (s^2 + 0.81) / (s^3 (s^2 + 1)): the same zeros on the axis.
  for (const bool integrals : {false, true}) {
    CAPTURE(integrals);
    const StateSpace L = integrals
                             ? ratio({20, 40, 20 * 1.81, 40 * 0.81, 20 * 0.81}, {1, 0, 1, 0, 0, 0})
                             : ratio({100, -18, 81}, {1, 0, 1, 0});
    const Margins m = margins(L, {.delay = 1e-3});
    CHECK_FALSE(m.stable);
    CHECK(m.nyquist.agree);
    CHECK(m.nyquist.closed_right == 2);
  }
}

TEST_CASE("a delayed loop with an undamped mode that L does not see is not stable") {
  StateSpace L = ratio({1}, {1, 1});
  const Eigen::MatrixXd A = L.A;
  L.A = Eigen::MatrixXd::Zero(3, 3), L.A(0, 0) = A(0, 0), L.A(1, 2) = 3, L.A(2, 1) = -3;
  L.B.conservativeResizeLike(Eigen::MatrixXd::Zero(3, 1));
  L.C.conservativeResizeLike(Eigen::MatrixXd::Zero(1, 3));
  for (const double delay : {0.0, 0.1}) {
    const Margins m = margins(L, {.delay = delay});
    CHECK(m.nyquist.closed_on_axis > 0);
    CHECK_FALSE(m.stable);
  }
}

TEST_CASE("|L| = 1 far beyond all poles and zeros") {
  // k / (s^2 + 0.02 s + 1): w^4 + (0.02^2 - 2) w^2 + 1 = k^2.
  for (const double k : {1e4, 1e8, 1e12}) {
    CAPTURE(k);
    const double half = 1 - 0.0002, w = std::sqrt(half + std::sqrt(half * half + k * k - 1));
    const LoopMargins m = one(ratio({k}, {1, 0.02, 1}));
    REQUIRE(m.unit.size() == 1);
    CHECK(std::abs(m.unit[0].omega / w - 1) <= 1e-9);
    CHECK(std::abs(m.phase.value / std::atan2(0.02 * w, w * w - 1) - 1) <= 1e-6);
  }
  // Next to 1 at high frequencies: no crossing, by rounding either.
  CHECK(one(ratio({1 - 1e-15, 1}, {1, 3})).unit.empty());
  // 1e6 s / (s + 1)^2: at 1e-6 and at 1e6, as w (1e6) = 1 + w^2.
  const LoopMargins m = one(ratio({1e6, 0}, {1, 2, 1}));
  REQUIRE(m.unit.size() == 2);
  CHECK(std::abs(m.unit[0].omega * 1e6 - 1) <= 1e-9);
  CHECK(std::abs(m.unit[1].omega / 1e6 - 1) <= 1e-9);
}

TEST_CASE("with a delay and a pole on the axis, or a direct term") {
  const Margins m = margins(ratio({1}, {1, 0}), {.delay = pi / 2});  // -1 at 1 rad/s
  CHECK(!m.stable);
  CHECK(m.nyquist.closed_on_axis == 1);
  for (const StateSpace& direct :
       {ratio({2, 1}, {1, 1}), ratio({0.9, 0.9}, {1, 2}), ratio({1}, {1})})
    CHECK(says(error_of([&] { margins(direct, {.delay = 1e-9}); }), Code::bad_value,
               {"direct term", "actuator"}));
  CHECK(says(error_of([&] {
               margins(ratio({1e6}, {1, 0}), {.delay = 5});
             }),
             Code::bad_value, {"delay of 5 s", "turns"}));
}

TEST_CASE("the delay margin of a loop that is not small at high frequencies is 0") {
  for (const double b : {0.5, 1.5}) {
    const LoopMargins m = one(ratio({2, b}, {1, 1}));
    CHECK(m.delay.value == 0);
    CHECK(m.delay.omega == kNone);
  }
  CHECK(one(ratio({0.9, 0.5}, {1, 1})).delay.value == kNone);
}

TEST_CASE("the unit circle touched at 0 alone, or everywhere, is not crossed") {
  CHECK(one(ratio({1}, {1, 1})).unit.empty());
  CHECK(one(ratio({1}, {1})).unit.empty());
  CHECK(one(ratio({2, 3}, {1, 4, 3})).phase.value == kNone);  // 1 at 0, falling
}

TEST_CASE("a disk margin is 2 at most") {
  for (const StateSpace& L : {ratio({0.5}, {1}), ratio({1, 2}, {1, 1}), ratio({1}, {1})}) {
    const DiskMargin disk = one(L).disk;
    CHECK(disk.alpha == 2);
    CHECK(disk.least_gain() == 0);
    CHECK(disk.largest_gain() == kNone);
  }
}

TEST_CASE("a pure gain and a lag with a direct term") {
  const LoopMargins m = one(ratio({0.5}, {1}));
  CHECK(m.larger_gain.value == kNone);
  CHECK(m.phase.value == kNone);
  CHECK(std::abs(m.nearest.value - 1.5) <= kClose);
  // -(s + 1) / (2 s + 8): -1/8 at 0, -1/2 at infinity.
  const LoopMargins l = one(ratio({-1, -1}, {2, 8}));
  CHECK(close(l.larger_gain, 2, NAN));
  CHECK(l.larger_gain.omega == kNone);
  CHECK(std::abs(l.nearest.value - 0.5) <= kClose);
}

TEST_CASE("unstable loops have no margins, and the text reports it") {
  const Margins m = margins(ratio({60}, {1, 3, 2, 0}));  // limit 6
  CHECK(!m.stable);
  CHECK(m.nyquist.closed_right == 2);
  CHECK(m.nyquist.open_right == 0);
  CHECK(m.nyquist.encirclements == 2);
  CHECK(m.nyquist.agree);
  CHECK(m.loops[0].phase.value == 0);
  CHECK(m.loops[0].larger_gain.value == 0);
  CHECK(m.disk.alpha == 0);
  CHECK(to_string(m).find("not stable") != std::string::npos);
  const Margins edge = margins(ratio({6}, {1, 3, 2, 0}));  // poles at +-sqrt(2) j
  CHECK(!edge.stable);
  CHECK(edge.nyquist.closed_on_axis == 2);
  const Margins sign = margins(ratio({-1}, {1, 0}));
  CHECK(!sign.stable);
  CHECK(sign.nyquist.closed_right == 1);
  CHECK(sign.nyquist.encirclements == 1);
}

TEST_CASE("two loops: each alone, and both at once") {
  // The spinning satellite of Doyle: K = 1, G = [s - a^2, a (s + 1); -a (s + 1), s - a^2] / (s^2 +
  // a^2). Each loop alone is 1 / s: infinite gain margins, 90 degrees; both at once a tenth.
  constexpr double a = 10;
  StateSpace L;
  L.A = MatrixXd(2, 2), L.B = MatrixXd::Identity(2, 2), L.C = MatrixXd(2, 2);
  L.A << 0, a, -a, 0;
  L.C << 1, a, -a, 1;
  L.D = MatrixXd::Zero(2, 2);
  L.inputs = L.outputs = {"roll", "pitch"};
  const Margins m = margins(L);
  CHECK(m.stable);
  CHECK(m.nyquist.encirclements == 0);
  REQUIRE(m.loops.size() == 2);
  for (const LoopMargins& l : m.loops) {
    CHECK(l.larger_gain.value == kNone);
    CHECK(l.smaller_gain.value == 0);
    CHECK(close(l.phase, pi / 2, 1));
    CHECK(std::abs(l.disk.alpha - 2) <= kClose);
  }
  CHECK(m.loops[0].point == "roll");
  // S = s/(s+1) [1, -a/s; a/s, 1] (by hand from T = [1, a; -a, 1] / (s + 1)): singular values
  // |s -+ j a| / |s + 1|, largest sqrt(1 + a^2) at w = 1 / a.
  CHECK(close(m.nearest, 1 / std::sqrt(1 + a * a), 1 / a));
  // S - T = [s - 1, -2 a; 2 a, s - 1] / (s + 1): |s - 1 -+ 2 j a|^2 = 1 + (w + 2 a)^2.
  const double w = -a + std::sqrt(a * a + 1);
  const double norm = std::sqrt((1 + (w + 2 * a) * (w + 2 * a)) / (1 + w * w));
  CHECK(std::abs(m.disk.alpha / (2 / norm) - 1) <= kClose);
  CHECK(std::abs(m.disk.omega / w - 1) <= 1e-6);
}

TEST_CASE("poles on the axis: an undamped mode, controlled by a rate") {
  // k s / (s^2 + w^2): phase from 90 to -90, closed loop damped; |L| = 1 at two frequencies.
  const double w = 7, k = 0.02;
  const LoopMargins m = one(ratio({k, 0}, {1, 0, w * w}));
  CHECK(m.larger_gain.value == kNone);
  CHECK(m.unit.size() == 2);
  const double root = std::sqrt(k * k + 4 * w * w);
  CHECK(std::abs(m.unit[0].omega / ((root - k) / 2) - 1) <= 1e-12);
  CHECK(std::abs(m.unit[1].omega / ((root + k) / 2) - 1) <= 1e-12);
  CHECK(close(m.phase, pi / 2, NAN));
  const Margins wrong = margins(ratio({-k, 0}, {1, 0, w * w}));
  CHECK(!wrong.stable);
  CHECK(wrong.nyquist.closed_right == 2);
  CHECK(wrong.nyquist.encirclements == 2);
  CHECK(wrong.nyquist.agree);
}

TEST_CASE("mistakes") {
  StateSpace wide = ratio({1}, {1, 1});
  wide.B = MatrixXd::Ones(1, 2), wide.D = MatrixXd::Zero(1, 2);
  CHECK(has_mistake(error_of([&] { margins(wide); }), Code::size, {"2", "1"}));
  CHECK(error_of([&] { margins(ratio({-1}, {1})); }).has(Code::ill_posed));
  CHECK(error_of([&] { margins(ratio({1}, {1, 1}), {.delay = -1}); }).has(Code::bad_value));
  CHECK(error_of([&] { margins(ratio({NAN}, {1, 1})); }).has(Code::not_finite));
  CHECK(std::abs(decibels(10) - 20) <= 1e-14);
  CHECK(std::abs(degrees(pi) - 180) <= 1e-12);
}

TEST_CASE("of a diagram's loop point") {
  Diagram d{"lag"};
  auto r = d.input("r");
  auto x = d.add("x", Integrator{});
  const auto u = d.loop_point("law", 3.0 * r - 3.0 * x.out);
  x.in = u;
  d.output("y") = x.out;
  const Margins m = margins(loop(compile(d), "law"));
  CHECK(m.stable);
  CHECK(m.loops.at(0).point == "law");
  CHECK(close(m.loops.at(0).phase, pi / 2, 3));
  CHECK(to_string(m).find("90.00 deg") != std::string::npos);
}

TEST_CASE("of a loop of a hundred states, most of which it does not reach") {
  // 50 equal undamped masses on a base of 50 kg: they move as one, with m = 50 kg and k = 500 N/m.
  // L = (50 s + 50) (s^2 + 10) / (50 s^2 (s^2 + 20)).
  Diagram d{"masses"};
  auto base = d.add("base", SpringMass{.mass = 50, .stiffness = 0});
  base.parent.accel = 0;
  for (int i = 0; i < 50; ++i)
    mount(d.add("z" + std::to_string(i), SpringMass{.mass = 1, .stiffness = 10}), base.child);
  base.child.force += d.loop_point("law", -50.0 * base.child.position - 50.0 * base.child.rate);
  d.output("x") = base.child.position;
  const Margins found = margins(loop(compile(d), "law")),
                exact = margins(ratio({1, 1, 10, 10}, {1, 0, 20, 0, 0}));
  CHECK(found.stable);
  CHECK(found.nyquist.closed_on_axis == 0);
  CHECK(found.warnings.empty());
  CHECK(close(found.loops.at(0).phase, exact.loops.at(0).phase.value, exact.loops[0].phase.omega));
  CHECK(close(found.nearest, exact.nearest.value, exact.nearest.omega));
}
