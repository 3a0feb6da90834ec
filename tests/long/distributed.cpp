#include <doctest/doctest.h>

#include "distributed/random_beams.hpp"

/// Random scenes of distributed beams and bodies through reduce_beams; see tests/distributed.
using namespace titop_test;

TEST_CASE("300 random scenes of distributed beams: error below the accuracy, least order") {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const RandomBeams scene(seed);
    const OrderBesideLeast r = order_beside_least(scene);
    INFO(seed << '\n' << to_string(r.reduced) << "least order found: " << r.least);
    CHECK(r.reduced.error.worst <= scene.scene.accuracy);
    CHECK(r.error <= scene.scene.accuracy);
    CHECK(r.least >= 0);
    CHECK(within(r.reduced.system.order(), r.least));
  }
}
