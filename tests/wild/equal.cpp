#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild hubs with two to four equal appendages are right, or refused rightly") {
  wild::demand_right({.name = "equal", .draw = wild::draw_equal});
}
