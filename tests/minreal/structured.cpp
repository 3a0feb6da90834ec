#include "structured.hpp"

/// Integrators, multiple poles, equal parts and loops: orders against ranks without rounding.

using namespace titop;
using titop_test::diagram;
using titop_test::structured_lti;
using titop_test::StructuredLti;

TEST_CASE("structured Lti: the order lies in the verdict's interval, and is that of the model") {
  for (const bool units : {false, true}) {
    int equal = 0, all = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
      CAPTURE(seed);
      CAPTURE(units);
      equal += titop_test::structured_order_holds(seed, units);
      ++all;
    }
    CHECK(equal >= 0.99 * all);
  }
}

TEST_CASE("structured Lti: exact arithmetic counts the same order") {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    CAPTURE(seed);
    const StructuredLti m = structured_lti(seed, true);
    const ExactOrder exact = exact_order(diagram(m.lti).graph());
    CHECK(exact.decided);
    CHECK(exact.order == m.order);
  }
}

TEST_CASE("structured Lti: certificates find no fault, also where states are not reached") {
  int zero = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    const StructuredLti m = structured_lti(seed, false);
    const FullCertificate c = certify(compile(diagram(m.lti)));
    CAPTURE(to_string(c));
    CHECK(c.holds());
    zero += m.order == 0;
  }
  CHECK(zero > 0);  // transfers that are 0 are among them
}
