#include "minreal/structured.hpp"

/// 4,000 structured Lti; with the 1,000 diagrams of tests/long/minimal.cpp, 5,000 planted orders.

TEST_CASE("4,000 structured Lti: the order lies in the verdict's interval, and is that of 99 %") {
  int equal = 0;
  for (const bool units : {false, true})
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
      CAPTURE(seed);
      CAPTURE(units);
      equal += titop_test::structured_order_holds(seed, units);
    }
  CHECK(equal >= 3960);
}
