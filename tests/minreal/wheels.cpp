#include "support/wheels.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <titop/titop.hpp>

#include "../../examples/scenes/wheels.hpp"

/// Reaction wheels on a free satellite: orders by momentum, counted by hand.

using namespace titop;
using namespace titop_test;

namespace {

template <class Check>
void all_satellites(const Check& check) {
  for (const bool law : {true, false})
    for (const int count : {0, 1, 3, 4})
      for (const double friction : {0.0, 1e-6, 1e-4})
        for (const bool off_centre : {true, false}) {
          if (count == 0 && (!law || friction > 0)) continue;
          const Wheels wheels{count, friction, law, off_centre};
          CAPTURE(law);
          CAPTURE(count);
          CAPTURE(friction);
          CAPTURE(off_centre);
          check(wheels, compile(satellite(wheels)));
        }
}

}  // namespace

TEST_CASE("wheels: the order is that of the momenta, and no pole lies right of the axis") {
  all_satellites([](const Wheels& wheels, const System& system) {
    const OrderVerdict verdict = system.order_verdict();
    CAPTURE(to_string(verdict));
    const int order = order_by_momentum(wheels);
    CHECK(verdict.lowest <= order);
    CHECK(verdict.highest >= order);
    if (wheels.count != 1) {  // one wheel: the boom's two bending modes share a frequency
      CHECK(verdict.order == order);
      CHECK(verdict.highest - verdict.lowest <= 1);
      for (const Pole& pole : system.poles()) {
        CHECK(pole.s.real() <= 0);
        if (pole.omega > 0) CHECK(pole.omega >= 1e-5);  // a wheel's bearing: 1e-6 / 0.08 rad/s
      }
    }
    CHECK(certify(system).holds());
  });
}

/// The angle of every wheel, the momenta about the axes of the wheels, and about an axis without
/// one angle and momentum of the whole; without friction also rates of wheels that exert no torque.
/// Without the law the hub's angles as well.
int zeros_by_momentum(const Wheels& w) {
  if (w.count == 0) return 0;
  const int axes = std::min(w.count, 3), idle = w.count - axes;
  if (!w.law) return w.count + 6 + (w.friction > 0 ? 0 : w.count);
  return w.count + axes + 2 * (3 - axes) + (w.friction > 0 ? 0 : idle);
}

TEST_CASE(
    "wheels: poles of the whole model: at 0 those of conserved momenta, none right of the axis") {
  all_satellites([](const Wheels& wheels, const System& minimal) {
    const System whole = compile(satellite(wheels), {.minimize_up_to = 0});
    int zeros = 0, others = 0;
    for (const Pole& pole : whole.poles()) {
      CHECK(pole.s.real() <= 0);
      // The slowest is that of a wheel's bearing, 1e-6 / 0.08 rad/s.
      if (pole.omega > 0) CHECK(pole.omega >= 1e-5);
      (pole.omega == 0 ? zeros : others) += pole.pair ? 2 : 1;
    }
    CHECK(zeros == zeros_by_momentum(wheels));
    CHECK(zeros + others == minimal.order());
  });
}

TEST_CASE("wheels: three poles of a minimal model at 0, as speeds integrate the torques on a hub") {
  for (const double h : {0.0, 0.1, 5.0, 40.0}) {
    CAPTURE(h);
    const std::vector<Pole> poles =
        compile(scenes::wheels::satellite(h, scenes::wheels::Motors::law)).poles();
    CHECK(std::count_if(poles.begin(), poles.end(), [](const Pole& p) { return p.omega == 0; }) ==
          3);
    CHECK(poles[3].omega > 0.01);  // the attitude under the law
  }
}

TEST_CASE("wheels: the model without their momenta has the transfer of the factors") {
  all_satellites([](const Wheels& wheels, const System& system) {
    const int speeds = wheels.count;
    for (const double omega : {1e-3, 0.03, 1.0, 60.0, 500.0}) {
      const std::complex<double> s(0.05 * omega, omega);
      const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50),
                             minimal = system.state_space().transfer(s);
      // Attitude about x of all; wheels about one axis do not turn the others.
      const auto att = exact.row(speeds);
      CHECK((minimal.row(speeds) - att).norm() <= 1e-9 * att.norm());
      if (speeds > 0)
        CHECK((minimal - exact).topRows(speeds).norm() <= 1e-9 * exact.topRows(speeds).norm());
    }
  });
}

TEST_CASE("wheels: three or four wheels become code") {
  for (const int count : {3, 4}) {
    const System system = compile(satellite({.count = count}));
    CHECK(generate_cpp(system, {.sample_time = 0.1}).error <= 1e-6);
  }
}

TEST_CASE("wheels: on a plate on springs, the order is decided, and that of the momenta") {
  // Positions of the boom's twelve modes and the plate's six axes; rates of these, of the four
  // wheels, and of the hub's three rotations. Of the wheels the motion that exerts no torque is not
  // driven; of the hub's rates the turn about the sum of the momenta (without them, all three) has
  // no effect on accelerations.
  for (const double h : {0.0, 1e-2, 1.0, 8.0, 40.0}) {
    CAPTURE(h);
    const System system = compile(scenes::wheels::satellite(h, scenes::wheels::Motors::off, true));
    const OrderVerdict verdict = system.order_verdict();
    CAPTURE(to_string(verdict));
    CHECK(verdict.order == (h == 0 ? 36 + 3 : 36 + 5));
    CHECK(verdict.decided());
  }
}
