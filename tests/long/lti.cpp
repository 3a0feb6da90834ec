#include "reduction/random_lti_scene.hpp"

/// 6,000 scenes of one dense Lti; see tests/reduction/lti.cpp.

TEST_CASE("6,000 random Lti: every error is below its theorem, no order above the minimal") {
  for (std::uint64_t seed = 0; seed < 6000; ++seed) {
    CAPTURE(seed);
    titop_test::check_scene_of_lti(seed);
  }
}
