#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild bodies on bushings, also in closed chains, are right, or refused rightly") {
  // Two springs in series leave the point between them loose to the last digit if the ranks of
  // their full matrices sum to less than six: 1 of 2,000 scenes is refused as improper though no
  // output sees that motion.
  wild::demand_right({.name = "bushings", .draw = wild::draw_bushings, .refused_falsely = 0.001});
}
