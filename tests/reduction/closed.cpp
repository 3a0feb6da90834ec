#include <doctest/doctest.h>

#include "loops/four_bars.hpp"
#include "loops/rings.hpp"
#include "scenes.hpp"
#include "support/close.hpp"

/// Closed chains through model reduction, against the whole structure's M and K by hand.
using namespace titop;
using namespace titop_test;
using namespace loops_test;

namespace {

/// Required of every reduced system: bounds are met, and undamped poles stay undamped.
void check(const ReducedSystem& r, const titop::Scene& scene, const Truth& truth) {
  check_beside(r, scene, truth);
  for (const Pole& p : poles(r.state_space())) CHECK(p.s.real() == 0);
}

}  // namespace

TEST_CASE("a ring of five beams, welded to itself and free") {
  const Ring ring{.beams = 5, .tube = {1, 0.05, 0.04, 3}, .far = 4};
  const Truth truth = accelerations(ring.by_hand(), 6);
  for (const double accuracy : {1e-2, 1e-5}) {
    const titop::Scene scene{.band_hz = {0, 300}, .accuracy = accuracy};
    const ReducedSystem r = compile(ring.diagram(), scene);
    check(r, scene, truth);
    CHECK(r.full().order() == 2 * (5 * 18 - 6));
    CHECK(r.order() <= r.full().order() / 3);
    // Poles of the band that are kept are those of the whole ring's M and K.
    for (const KeptMode& m : r.modes()) {
      if (!m.exact) continue;
      double nearest = 1;
      for (const double w : truth.omegas)
        nearest = std::min(nearest, relative(2 * pi * m.hertz, w));
      CHECK(nearest <= 1e-8);
    }
  }
}

TEST_CASE("a four-bar mechanism whose crank is locked: wrench and acceleration at its tip") {
  for (const Space space : {Space::full, Space::planar}) {
    CAPTURE((space == Space::planar));
    titop::Scene scene{.band_hz = {0, 400}, .accuracy = 1e-4};
    if (space == Space::planar) {  // nothing moves out of the plane
      scene.inputs = {"U(1)", "U(2)", "U(6)"};
      scene.outputs = {"a(1)", "a(2)", "a(6)"};
    }
    const ReducedSystem r = compile(mechanism(pi / 2, space, Ports::driven), scene);
    by_hand::Structure a = mechanism_by_hand(pi / 2, space);
    if (space == Space::planar) {
      const std::vector<Index> plane{0, 1, 5};
      a.B = MatrixXd(a.B(Eigen::all, plane));
      a.C = MatrixXd(a.C(plane, Eigen::all));
    }
    check(r, scene, accelerations(a, 0));
    CHECK(r.full().order() == (space == Space::full ? 102 : 54));
    CHECK(r.order() <= r.full().order() / 2);
  }
}
