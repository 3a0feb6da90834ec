#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild trees of bodies and joints are right, or refused rightly") {
  wild::demand_right({.name = "trees", .draw = wild::draw_tree});
}
