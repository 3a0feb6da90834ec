#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild loops of gains up to 1e-6 from 1 are right") {
  wild::demand_right({.name = "steep_gains", .draw = wild::draw_steep_gains});
}
