#include "support/wheels.hpp"

#include <doctest/doctest.h>

#include <titop/titop.hpp>

/// Reaction wheels add no states to the attitude that a law keeps.

using namespace titop;
using namespace titop_test;

TEST_CASE("wheels: the attitude from 0 Hz has the order that it has without wheels") {
  for (const double accuracy : {1e-1, 1e-3, 1e-5}) {
    const Scene attitude{
        .inputs = {"ref"}, .outputs = {"att"}, .band_hz = {0, 5}, .accuracy = accuracy};
    const int without = compile(satellite({.count = 0}), attitude).order();
    CHECK(without <= 17);
    for (const int count : {3, 4})
      for (const double friction : {0.0, 1e-6, 1e-4}) {
        CAPTURE(accuracy);
        CAPTURE(count);
        CAPTURE(friction);
        const ReducedSystem with =
            compile(satellite({.count = count, .friction = friction}), attitude);
        CHECK(with.order() <= without + 2);
        CHECK(with.bound().worst <= accuracy);
      }
  }
}
