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

TEST_CASE("wheels: with one, the pairs that nothing connects are 0 in the reduced model, too") {
  const Wheels one{.count = 1};
  for (const double accuracy : {1e-1, 1e-3, 1e-5}) {
    CAPTURE(accuracy);
    const ReducedSystem reduced = compile(
        satellite(one),
        Scene{.inputs = {"ref"}, .outputs = {"att"}, .band_hz = {0, 5}, .accuracy = accuracy});
    CHECK(reduced.order() <= order_by_momentum(one));
    CHECK(reduced.bound().worst <= accuracy);
    CHECK(reduced.transfer({0, 0.5}).rightCols(2).isZero(0));
  }
  for (const char* ref : {"ref(2)", "ref(3)"})
    for (const char* att : {"att(1)", "att(2)", "att(3)"}) {
      CAPTURE(ref);
      CAPTURE(att);
      const ReducedSystem nothing =
          compile(satellite(one), Scene{.inputs = {ref}, .outputs = {att}, .band_hz = {0, 5}});
      CHECK(nothing.order() == 0);
      CHECK(nothing.transfer({0, 0.5}).isZero(0));
    }
}
