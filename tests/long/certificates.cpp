#include "generate/diagrams/random_diagram.hpp"
#include "support/certified.hpp"
#include "support/structured_lti.hpp"

/// Certificates of 2,100 right models and of more than 500 with a planted fault.

using namespace titop;

TEST_CASE("2,000 structured Lti and 100 random scenes: no fault; 500 planted faults: all found") {
  titop_test::FaultCount count;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    CAPTURE(seed);
    const Lti lti = titop_test::structured_lti(seed / 2, seed % 2 == 1).lti;
    Diagram d{"alone"};
    auto k = d.add("k", lti);
    k.in = d.input("u", static_cast<int>(lti.B.cols()));
    d.output("y", static_cast<int>(lti.C.rows())) = k.out;
    check_faults(d, seed, 1, count);
  }
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    check_faults(titop::generate::random_diagram(titop::generate::random_options(seed)).build(),
                 seed, 1, count);
  }
  CHECK(count.right == 2100);
  CHECK(count.minimal >= 500);
  CHECK(count.written >= 500);
  CHECK(count.missed * 100 <= count.written);
}
