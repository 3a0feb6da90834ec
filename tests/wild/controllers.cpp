#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild controllers alone and around mechanics are right") {
  wild::demand_right({.name = "controllers",
                      .draw = wild::draw_controller,
                      .pending = "not yet judged since the LU of s - A is mended"});
}
