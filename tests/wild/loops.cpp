#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild closed chains are right, or refused rightly") {
  wild::demand_right({.name = "loops", .draw = wild::draw_loop});
}
