#include <doctest/doctest.h>

#include "rings.hpp"

using namespace loops_test;
using namespace titop;

TEST_CASE("ring of eight flexible beams, free: order 372, poles as the whole ring's M and K") {
  const Ring ring{.beams = 8, .tube = {1, 0.05, 0.04, 4}, .far = 5};
  const System system = compile(ring.diagram());
  const by_hand::Structure a = ring.by_hand();
  CHECK(system.state_space().order() == 372);
  const auto poles = all_poles(system);
  CHECK(by_hand::pole_error(poles, elastic_poles(a, 6)) <= 1e-8);
  const auto s = points({30, 200, 900, 4000, 30000});
  std::vector<MatrixXcd> exact;
  for (const Complex z : s) exact.push_back(by_hand::accel_transfer(a, z));
  CHECK(error_3(responses(system, s), exact) <= 1e-9);
  CHECK(error_3(responses(system.state_space(), s), exact) <= 1e-8);
  CHECK(compile(ring.diagram(3)).states() == system.states());
}
