#include <doctest/doctest.h>

#include "wild/parts/family.hpp"

TEST_CASE("wild rows of spring-masses, lossless to very lossy, are right") {
  wild::demand_right({.name = "rows", .draw = wild::draw_row});
}
