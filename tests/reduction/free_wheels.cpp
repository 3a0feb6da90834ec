#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/wheels.hpp"

/// Free satellites with rotors: momenta are constant, which a second-order form cannot say.

using namespace titop;
using namespace titop_test;

TEST_CASE("wheels: in free motion, no more states than the momenta leave, to any accuracy") {
  for (const int count : {1, 3, 4})
    for (const double friction : {0.0, 1e-4}) {
      const Wheels wheels{.count = count, .friction = friction, .law = false};
      CAPTURE(count);
      CAPTURE(friction);
      for (const bool all : {false, true}) {
        Scene scene{.outputs = {"att"}, .band_hz = {1e-3, 50}, .accuracy = 1e-6};
        if (all) scene.outputs.clear();
        const ReducedSystem reduced = compile(satellite(wheels), scene);
        // One wheel: the boom's two bending modes share a frequency (tests/minreal/wheels.cpp).
        const int most =
            count == 1 ? reduced.full().order_verdict().highest : order_by_momentum(wheels);
        CHECK(reduced.order() <= most);
        CHECK(reduced.bound().worst <= scene.accuracy);
      }
    }
}

// Six rates, of motions without stiffness whose positions nobody reads: as many states as the
// minimal model has.
TEST_CASE("a free body whose rates are read keeps its second-order form") {
  Diagram d{"free"};
  auto hub = d.add("hub", RigidBody{.mass = 3, .inertia = Eigen::Vector3d(1, 2, 2.5).asDiagonal()});
  hub.parent.force = -d.input("U", 6);
  d.output("v", 6) = hub.parent.rate;
  const ReducedSystem r = compile(d, Scene{.band_hz = {0.1, 1}, .accuracy = 1e-3});
  CHECK(r.order() == 6);
  CHECK(r.second_order().M.rows() == 6);
}
