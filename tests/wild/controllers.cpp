#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild controllers alone and around mechanics are right") {
  // Chains of seven and more integrators have loop gains of 1e14 and more, of which double leaves
  // two digits: 6 of 2,000 scenes are refused.
  wild::demand_right(
      {.name = "controllers", .draw = wild::draw_controller, .refused_falsely = 0.005});
}
