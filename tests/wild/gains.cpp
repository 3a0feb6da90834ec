#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild loops of gains, alone and around mechanics, are right") {
  wild::demand_right({.name = "gains", .draw = wild::draw_gains});
}
