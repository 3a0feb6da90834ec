// Momenta and rotors in trees and closed chains: maximal coordinates, and reversed momenta.
#include <doctest/doctest.h>

#include "support/half_ties.hpp"

using namespace half_ties;
using namespace titop;

namespace {

bool has_rotor(const Sketch& sketch) {
  for (const Body& b : sketch.bodies)
    for (const Momentum& m : b.momenta)
      if (m.rotor) return true;
  return false;
}

}  // namespace

TEST_CASE("momenta and rotors in 200 trees and closed chains: by hand, and G(h)' = G(-h)") {
  Rng rng(20261130);
  int judged = 0, gyroscopic = 0, closed = 0, rotors = 0;
  for (int i = 0; judged < 200; ++i) {
    CAPTURE(i);
    Sketch sketch = draw(rng, i % 2 == 1);
    if (i % 3 == 0)
      std::erase_if(sketch.ties, [](const HalfTie& t) { return t.target_point >= 0; });
    sketch.seen = sketch.load, sketch.seen_point = sketch.load_point;
    draw_momenta(rng, sketch, 5);
    REQUIRE(i < 250);
    const Oracle o = oracle(sketch);
    if (o.gap < 1e-4) continue;  // near singular
    ++judged;
    closed += i % 3 != 0;
    rotors += has_rotor(sketch);
    const System ahead = compile(diagram(sketch)), back = compile(diagram(reversed(sketch)));
    bool one_way = false;
    for (const std::complex<double> s : {std::complex<double>(0.3, 1.3), {0.5, 6}}) {
      const MatrixXcd H = o.rate(s), G = ahead.transfer(s);
      const double size = std::max(H.norm(), 1e-12);
      CHECK((G - H).norm() <= 1e-8 * size);
      CHECK((G.transpose() - back.transfer(s)).norm() <= 1e-10 * size);
      one_way = one_way || (G.transpose() - G).norm() > 1e-6 * size;
    }
    gyroscopic += one_way;
  }
  CHECK(closed >= 120);
  CHECK(rotors >= 80);
  CHECK(2 * gyroscopic > judged);  // most of them are not reciprocal as they are
}
