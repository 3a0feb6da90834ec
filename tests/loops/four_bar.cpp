#include <doctest/doctest.h>

#include "four_bars.hpp"
#include "support/notes.hpp"

using namespace loops_test;
using namespace titop;

TEST_CASE("four-bar with flexible links, crank locked at 0, 90 and 180 degrees") {
  for (const Space space : {Space::full, Space::planar})
    for (const double crank : {0.0, pi / 2, pi}) {
      CAPTURE(crank);
      CAPTURE((space == Space::planar));
      const System system = compile(mechanism(crank, space));
      const by_hand::Structure a = mechanism_by_hand(crank, space);
      CHECK(system.state_space().order() == (space == Space::full ? 102 : 54));
      CHECK(2 * a.M.rows() == (space == Space::full ? 102 : 54));
      CHECK(by_hand::pole_error(all_poles(system), elastic_poles(a, 0)) <= 1e-9);
      const bool told =
          titop_test::noted(system, titop::Note::Kind::info, "chains", {"3", "6", "x", "y", "z"});
      CHECK(told == (space == Space::planar));
    }
}
