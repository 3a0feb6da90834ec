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

TEST_CASE("a peak without a derivative is refused with both of what is equal") {
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
  const Derivatives undamped = derivatives(pair(2, 9, 0), {"k"});
  CHECK(says(error_of([&] { undamped.peak(); }), Code::singular, {"2.1213"}));
}
