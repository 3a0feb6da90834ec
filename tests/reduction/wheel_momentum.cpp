#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "../../examples/scenes/wheels.hpp"
#include "against.hpp"
#include "support/mistakes.hpp"

/// Wheels with momentum: reduced models keep their bound and are stable at all wheel speeds.

using namespace titop;
using namespace titop_test;

TEST_CASE("wheels with momentum under a law: the bound holds at any wheel speed, poles stay left") {
  for (const double h : {0.0, 5.0, 20.0, 40.0, 100.0}) {
    CAPTURE(h);
    const Diagram d = scenes::wheels::satellite(h, scenes::wheels::Motors::law);
    const Scene scene{.outputs = {"turn"}, .band_hz = {0, 5}, .accuracy = 1e-3};
    const ReducedSystem reduced = compile(d, scene);
    const ErrorBound& bound = reduced.bound();
    CHECK(bound.worst <= scene.accuracy);
    const auto exact = [&](std::complex<double> s) {
      return reduced.full().transfer(s, Precision::twofold);
    };
    const Compared c = compared(scene, fine_points(scene, {}, 200), {exact, {}},
                                [&](std::complex<double> s) { return reduced.transfer(s); });
    CHECK((c.error.array() <= bound.pairs.array() * bound.peak.array()).all());
    for (const Pole& p : poles(reduced.state_space())) CHECK(p.s.real() < 0);
    // A constant torque makes the wheels ever faster; no state is the integral alone.
    CHECK(says(error_of([&] {
                 compile(d, Scene{.band_hz = {0, 5}});
               }),
               Code::bad_value, {"speed1", "U(1)", "band_hz"}));
  }
}
