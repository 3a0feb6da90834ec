#include "random_lti_scene.hpp"

/// Scenes of one dense Lti: bounds that are theorems, and orders up to the minimal one.

TEST_CASE("Lti: of 200 random ones every error is below its theorem, no order above the minimal") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    titop_test::check_scene_of_lti(seed);
  }
}
