#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild beams in trees and closed chains are right, or refused rightly") {
  wild::demand_right({.name = "beams", .draw = wild::draw_beams});
}
