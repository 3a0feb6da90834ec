#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <string>
#include <titop/titop.hpp>
#include <vector>

/// Slow poles together with fast ones, against closed forms.

using namespace titop;

namespace {

/// Springs of these rates on the wall, in parallel, under one force.
Diagram side_by_side(std::initializer_list<SpringMass> springs) {
  Diagram d{"side by side"};
  auto u = d.input("u");
  auto y = d.output("a");
  int i = 0;
  for (const SpringMass& s : springs) {
    auto z = d.add("z" + std::to_string(++i), s);
    ground(z);
    z.child.force = u;
    d.output("x" + std::to_string(i)) = z.stretch;
    if (i == 1) y = z.child.accel;
  }
  return d;
}

double off(double found, long double right) {
  return static_cast<double>(std::abs(found / right - 1));
}

}  // namespace

TEST_CASE("poles: a slow mode is no rigid motion, however fast another one is") {
  const auto poles = compile(side_by_side({{.mass = 1, .stiffness = 1},
                                           {.mass = 1, .stiffness = 4},
                                           {.mass = 1e-3, .stiffness = 1e11}}))
                         .poles();
  REQUIRE(poles.size() == 3);
  for (const Pole& p : poles) {
    CHECK(p.pair);
    CHECK(p.s.real() == 0);
  }
  CHECK(off(poles[0].omega, 1) <= 1e-15);
  CHECK(off(poles[1].omega, 2) <= 1e-15);
  CHECK(off(poles[2].omega, 1e7L) <= 1e-15);
  CHECK(poles[0].blocks == std::vector<std::pair<std::string, double>>{{"z1", 1.0}});
}

TEST_CASE("poles: two coupled masses whose frequencies are nine decades apart") {
  // On a stiff spring, and on a soft one behind it.
  const double m1 = 2, k1 = 1e14, m2 = 3, k2 = 1e-5;
  Diagram d{"soft behind stiff"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = m1, .stiffness = k1});
  auto z2 = d.add("z2", SpringMass{.mass = m2, .stiffness = k2});
  ground(z1);
  z2.parent.accel = z1.child.accel;
  z1.child.force = z2.parent.force;
  z2.child.force = u;
  d.output("a") = z2.child.accel;
  // lambda^2 - b lambda + c = 0, the slow root by the product.
  const long double b = (static_cast<long double>(k1) + k2) / m1 +
                        static_cast<long double>(k2) / m2,
                    c = static_cast<long double>(k1) * k2 / m1 / m2,
                    fast = b / 2 + std::sqrt(b * b / 4 - c), slow = c / fast;
  const auto poles = compile(d, {.minimize_up_to = 0}).poles();
  REQUIRE(poles.size() == 2);
  CHECK(off(poles[0].omega, std::sqrt(slow)) <= 1e-14);
  CHECK(off(poles[1].omega, std::sqrt(fast)) <= 1e-14);
}

TEST_CASE("poles: overdamped, critical and nearly critical modes; the slow one keeps its digits") {
  const double m = 2, k = 3;
  const double critical = 2 * std::sqrt(m * k);
  for (const double c : {1.5 * critical, 1e2, 1e6, 1e9, 1e14}) {
    CAPTURE(c);
    const auto poles = compile(side_by_side({{.mass = m, .stiffness = k, .damping = c}})).poles();
    REQUIRE(poles.size() == 2);
    const long double half = static_cast<long double>(c) / m / 2, w2 = 1.5L,
                      fast = half + std::sqrt(half * half - w2), slow = w2 / fast;
    CHECK(!poles[0].pair);
    CHECK(off(-poles[0].s.real(), slow) <= 1e-14);
    CHECK(off(-poles[1].s.real(), fast) <= 1e-14);
    CHECK(poles[0].damping == 1);
  }
  const auto below = compile(side_by_side({{.mass = 1, .stiffness = 4, .damping = 0.4}})).poles();
  REQUIRE(below.size() == 1);
  CHECK(off(below[0].omega, 2) <= 1e-15);
  CHECK(off(below[0].damping, 0.1L) <= 1e-15);
  const auto at = compile(side_by_side({{.mass = 1, .stiffness = 4, .damping = 4}})).poles();
  REQUIRE(at.size() ==
          2);  // a double pole at -2: rounding moves it by no more than its square root
  for (const Pole& p : at) CHECK(off(-p.s.real(), 2) <= 1e-15);
}

TEST_CASE("minimal: slow modes beside a fast one all stay, and one that nobody sees goes") {
  // By the stretches of all three every mode is needed; slow modes are not taken for one another.
  const System all = compile(side_by_side({{.mass = 1, .stiffness = 1},
                                           {.mass = 1, .stiffness = 4},
                                           {.mass = 1e-3, .stiffness = 1e11}}));
  CHECK(all.state_space().order() == 6);
  CHECK(all.order_verdict().decided());
  // One sum of all stretches: still six, as their frequencies differ.
  Diagram d{"sum"};
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 1});
  auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 4});
  auto c = d.add("c", SpringMass{.mass = 1e-3, .stiffness = 1e11});
  auto e = d.add("e", SpringMass{.mass = 3, .stiffness = 0.3});
  for (auto* z : {&a, &b, &c}) {
    ground(*z);
    z->child.force = u;
  }
  ground(e);
  e.child.force = 0;
  d.output("x") = a.stretch + b.stretch + c.stretch;
  d.output("unmoved") = e.stretch;
  const StateSpace m = compile(d).state_space();
  CHECK(m.order() == 6);
  const std::complex<double> s{0.1, 1.3};
  const auto one = [&](double mass, double k) { return 1.0 / (mass * s * s + k); };
  CHECK(std::abs(m.transfer(s)(0, 0) / (one(1, 1) + one(1, 4) + one(1e-3, 1e11)) - 1.0) <= 1e-13);
}

namespace {

/// Two equal rows wall - a - b. The stretch of the last spring of each drives the last mass of the
/// other, with opposite signs: no spring does that.
Diagram whirl(double light, double stiffness, double heavy, double push) {
  Diagram d{"whirl"};
  auto u = d.input("u");
  std::vector<decltype(d.add("", SpringMass{}))> a, b;
  for (const char* row : {"1", "2"}) {
    a.push_back(d.add("a" + std::string(row), SpringMass{.mass = light, .stiffness = stiffness}));
    b.push_back(d.add("b" + std::string(row), SpringMass{.mass = heavy, .stiffness = stiffness}));
    ground(a.back());
    mount(b.back(), a.back().child);
  }
  b[0].child.force = push * a[1].stretch + push * b[1].stretch + u;
  b[1].child.force = -push * a[0].stretch - push * b[0].stretch;
  d.output("x") = a[0].stretch + b[0].stretch;
  return d;
}

/// x1 + j x2 is one row under -j push x: (m L + 2 k)(M L + k + j push) = k^2, its slow L = s^2.
std::complex<long double> slow_pole(long double m, long double k, long double M, long double push) {
  using Long = std::complex<long double>;
  const Long b = (m * Long(k, push) + 2 * k * M) / (2 * m * M),
             c = (2 * k * Long(k, push) - k * k) / (m * M);
  return std::sqrt(c / (-b - std::sqrt(b * b - c)));
}

}  // namespace

TEST_CASE("poles: feedback that decides on a slow mode is not lost beside a fast one") {
  struct {
    double m, k, M, push;
  } const rows[] = {{1e-9, 1, 1, 0.1}, {1e-3, 1000, 100, 0.01}, {1e-5, 1000, 10, 0.05}};
  for (const auto& [m, k, M, push] : rows) {
    CAPTURE(m);
    const System s = compile(whirl(m, k, M, push));
    const auto right = slow_pole(m, k, M, push);
    const auto poles = s.poles();
    REQUIRE(poles.size() >= 2);
    for (int i : {0, 1}) {
      const Pole& p = poles[static_cast<std::size_t>(i)];
      CHECK(off(std::abs(p.s.real()), std::abs(right.real())) <= 1e-3);  // eps k / m
      CHECK(off(p.omega, std::abs(right)) <= 1e-6);
    }
    CHECK((poles[0].s.real() < 0) != (poles[1].s.real() < 0));
    // At such s an error in the resonance of an undamped mode would be large.
    const auto beside = std::abs(right) + 2 * std::abs(right.real());
    const std::complex<double> at(0, static_cast<double>(beside));
    const auto exact = s.transfer(at, Precision::digits50);
    CHECK(std::abs(s.state_space().transfer(at)(0, 0) / exact(0, 0) - 1.0) <= 1e-3);
  }
}
