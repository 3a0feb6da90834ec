#include "generate/diagrams/random_diagram.hpp"
#include "support/alone.hpp"
#include "support/certified.hpp"
#include "support/structured_lti.hpp"

/// Faults planted in models, in number: each is found, and the models without one have none.

using namespace titop;
using titop_test::alone;
using titop_test::structured_lti;

TEST_CASE("structured Lti: no fault; of planted ones each that changes the transfer is found") {
  titop_test::FaultCount count;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    CAPTURE(seed);
    check_faults(alone(structured_lti(seed, seed % 2 == 1).lti), seed, 2, count);
  }
  CHECK(count.minimal >= 25);
  CHECK(count.written >= 12);
  CHECK(count.missed == 0);
}

TEST_CASE("random scenes: no fault; of planted ones each that changes the transfer is found") {
  titop_test::FaultCount count;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    check_faults(titop::generate::random_diagram(titop::generate::random_options(seed)).build(),
                 seed, 1, count);
  }
  CHECK(count.minimal + count.written >= 4);
  CHECK(count.missed == 0);
}

/// Structured Lti whose certificates have called right models faulty: outputs that are 0 by
/// structure (762, 1022) or because two states cancel (4736), states in far units (482, 1021), and
/// states that were put back (1256, 1922, 3262, 3264, 3697, 4907).
TEST_CASE("certificates of right Lti: zeros, far units and restored entries are no faults") {
  for (const std::uint64_t seed :
       {482U, 762U, 1021U, 1022U, 1256U, 1922U, 3262U, 3264U, 3697U, 4736U, 4907U})
    for (const bool units : {false, true}) {
      CAPTURE(seed);
      CAPTURE(units);
      const titop_test::StructuredLti m = structured_lti(seed, units);
      const FullCertificate c = certify(compile(alone(m.lti)));
      CAPTURE(to_string(c));
      CHECK(c.holds());
      CHECK(c.order.lowest <= m.order);
      CHECK(c.order.highest >= m.order);
    }
}
