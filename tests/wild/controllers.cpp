#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild controllers alone and around mechanics are right") {
  wild::demand_right({.name = "controllers",
                      .draw = wild::draw_controller,
                      .pending = "outputs that loops cancel are right to their terms only"});
}
