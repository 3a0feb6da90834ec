#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild bodies tied along some axes only are right") {
  wild::demand_right({.name = "half_ties", .draw = wild::draw_half_ties});
}
