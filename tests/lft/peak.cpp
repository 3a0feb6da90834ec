#include <doctest/doctest.h>

#include <algorithm>

#include "lft/n17.hpp"
#include "support/mistakes.hpp"

/// Derivatives of the largest gain against closed forms and against differences.

using namespace lft_test;

namespace {

/// m xdd + c xd + k x = u: two of them, side by side, of the second with other numbers.
System pair(double m2, double k2, double c2) {
  Diagram d{"pair"};
  auto a = d.add("a", SpringMass{.mass = d.param("m", 2),
                                 .stiffness = d.param("k", 8),
                                 .damping = d.param("c", 0.3)});
  auto b = d.add("b", SpringMass{.mass = m2, .stiffness = k2, .damping = c2});
  ground(a), ground(b);
  a.child.force = d.input("u"), b.child.force = d.input("v");
  d.output("x") = a.stretch, d.output("y") = b.stretch;
  return compile(d);
}

double off(double x, double exact) { return std::abs(x / exact - 1); }

}  // namespace

TEST_CASE("the peak of an oscillator in closed form") {
  // 1 / (c r), r^2 = k / m - c^2 / (4 m^2)
  const double m = 2, k = 8, c = 0.3, r = std::sqrt(k / m - c * c / (4 * m * m)), P = 1 / (c * r);
  const PeakSlopes p = derivatives(pair(1, 50, 1), {"m", "k", "c"}).peak();
  CHECK(off(p.value, P) <= 1e-13);
  CHECK(off(p.omega, std::sqrt(k / m - c * c / (2 * m * m))) <= 1e-10);
  CHECK(off(p.slopes(0), -P / (2 * r * r) * (-k / (m * m) + c * c / (2 * m * m * m))) <= 1e-10);
  CHECK(off(p.slopes(1), -P / (2 * r * r * m)) <= 1e-10);
  CHECK(off(p.slopes(2), -P / c + P * c / (4 * m * m * r * r)) <= 1e-10);
}

TEST_CASE("a peak at an end of the band, and at infinity") {
  // 1 / sqrt(N), N = (k - m w^2)^2 + c^2 w^2, rising up to the resonance at 2 rad/s
  const double m = 2, k = 8, c = 0.3, w = 2 * std::numbers::pi * 0.2, stiff = k - m * w * w,
               P = 1 / std::hypot(stiff, c * w);
  const PeakSlopes low = derivatives(pair(1, 500, 1), {"m", "k", "c"}).peak({.band_hz = {0, 0.2}});
  CHECK(off(low.value, P) <= 1e-13);
  CHECK(off(low.omega, w) <= 1e-15);
  CHECK(off(low.slopes(0), P * P * P * stiff * w * w) <= 1e-12);
  CHECK(off(low.slopes(1), -P * P * P * stiff) <= 1e-12);
  CHECK(off(low.slopes(2), -P * P * P * c * w * w) <= 1e-12);

  Diagram d{"lead"};  // (p s + 1) / (s + 1)
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  auto high = d.add("high", Lti{.A = -one, .B = one, .C = -one, .D = one});
  auto rest = d.add("rest", Lti{.A = -one, .B = one, .C = one});
  const auto u = d.input("u");
  high.in = u, rest.in = u;
  d.output("y") = d.param("p", 3) * high.out + rest.out;
  const PeakSlopes end = derivatives(compile(d), {"p"}).peak();
  CHECK(std::isinf(end.omega));
  CHECK(off(end.value, 3) <= 1e-15);
  CHECK(off(end.slopes(0), 1) <= 1e-15);
}

TEST_CASE("a pole on the axis that no output sees is none of the peak") {
  Diagram d{"beside"};  // beside the oscillator of the closed form: one without damping, not read
  auto hidden = d.add("hidden", SpringMass{.mass = 1, .stiffness = 9});
  auto seen = d.add("seen", SpringMass{.mass = 2, .stiffness = d.param("k", 8), .damping = 0.3});
  ground(hidden), ground(seen);
  const auto u = d.input("u");
  hidden.child.force = u, seen.child.force = u;
  d.output("x") = seen.stretch;
  const double r = std::sqrt(4 - 0.3 * 0.3 / 16), P = 1 / (0.3 * r);
  const PeakSlopes p = derivatives(compile(d), {"k"}).peak();
  CHECK(off(p.value, P) <= 1e-13);
  CHECK(off(p.slopes(0), -P / (2 * r * r * 2)) <= 1e-10);
}

TEST_CASE("the satellite's peak in a band against differences of the norm") {
  const Satellite s{.xi = 0.02};
  const System system = compile(s.diagram());
  const HinfOptions band{.band_hz = {0.1, 0.9}};
  const PeakSlopes p = derivatives(system, s.names).peak(band);
  const auto at = [&](std::size_t i, double h) {
    StateSpace m;
    system.update({{s.names[i], system.parameters()[i].second + h}}).write(m);
    return norm_hinf(m, band).value;
  };
  const double step[] = {0.5, 1e-3, 1e-3, 1e-5};
  for (std::size_t i = 0; i < 4; ++i) {
    CAPTURE(s.names[i]);
    const double h = step[i], wide = (at(i, h) - at(i, -h)) / (2 * h),
                 narrow = (at(i, h / 2) - at(i, -h / 2)) / h, difference = (4 * narrow - wide) / 3;
    CHECK(std::abs(p.slopes(static_cast<Eigen::Index>(i)) - difference) <=
          1e-6 * std::abs(difference));
  }
}

TEST_CASE("a peak without a derivative is refused with both equal values") {
  using titop_test::error_of;
  const auto says = [](const Error& error, Code code, std::initializer_list<const char*> digits) {
    return error.has(code) && std::ranges::all_of(digits, [&](const char* d) {
             return std::string(error.what()).find(d) != std::string::npos;
           });
  };
  // Peaks of one height at other frequencies: the same k, and c so that the damping ratio is.
  const Derivatives two = derivatives(pair(8, 8, 0.6), {"k"});
  CHECK(says(error_of([&] { two.peak(); }), Code::bad_value, {"1.9971", "0.99859"}));
  CHECK(two.peak({.band_hz = {0.2, 1}}).omega > 1.9);
  // The same oscillator twice: two equal singular values.
  CHECK(says(error_of([] { derivatives(pair(2, 8, 0.3), {"k"}).peak(); }), Code::bad_value,
             {"1.9971"}));
  // (s + p - 2) / (s + p) with p = 1: 1 everywhere, of slope -1 at 0 and 0 at infinity.
  Diagram d{"pass"};
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  auto f = d.add("f", Lti{.A = -one,
                          .B = one,
                          .C = -2 * one,
                          .D = one,
                          .values = {{'A', 1, 1, -1 * d.param("p", 1)}}});
  f.in = d.input("u");
  d.output("y") = f.out;
  const Derivatives pass = derivatives(compile(d), {"p"});
  CHECK(says(error_of([&] { pass.peak(); }), Code::bad_value, {"rad/s"}));
  CHECK(says(error_of([&] { pass.peak({.band_hz = {0.1, 3}}); }), Code::bad_value, {"rad/s"}));
  const Derivatives undamped = derivatives(pair(2, 9, 0), {"k"});
  CHECK(says(error_of([&] { undamped.peak(); }), Code::singular, {"2.1213"}));
}
