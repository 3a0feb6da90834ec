#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "loops/assembly.hpp"

/// A ring of eight beams, pushed out of its plane at one corner and watched at the opposite one.

using namespace loops_test;
using namespace titop;

namespace {

Diagram ring() {
  const FlexibleBody body = Tube{1, 0.05, 0.04, 4}.beam();
  Diagram d{"ring"};
  std::vector<BodyHandle> b;
  for (int i = 0; i < 8; ++i) b.push_back(d.add("b" + std::to_string(i), body));
  const Rotation T = Rotation::about({0, 0, 1}, pi / 4);
  for (std::size_t i = 0; i < 8; ++i) mount(b[(i + 1) % 8], b[i].child, T);
  b[0].child.force += MatrixXd(VectorXd::Unit(6, 2)) * d.input("f");  // corner 1
  d.output("a") = b[5].parent.accel.along({0, 0, 1});                 // corner 5
  return d;
}

/// Out-of-plane motions that are even in the mirror through corners 1 and 5: of 32 nodes, 15 pairs
/// with (uz, rx, ry) each, and the two on the mirror with uz and one rotation; less the even rigid
/// motions, uz and the rotation about the axis across the mirror.
constexpr int kEven = 2 * (15 * 3 + 2 * 2 - 2);

}  // namespace

TEST_CASE("ring of eight beams, one input and one output: smaller by its mirror symmetries") {
  const System system = compile(ring(), {.minimize_up_to = 400, .resolution = 1e-8});
  CHECK(system.order() == 372);
  CHECK(system.state_space().order() == kEven);
  const auto s = points({30, 200, 900, 4000});
  CHECK(by_hand::transfer_error(responses(system.state_space(), s), responses(system, s)) <= 1e-7);
}

TEST_CASE(
    "ring of eight beams, one input and one output: without a resolution, inside the interval") {
  const System system = compile(ring(), {.minimize_up_to = 400});
  const OrderVerdict& v = system.order_verdict();
  CHECK(v.judged);
  CHECK(v.lowest <= kEven);
  CHECK(v.highest >= kEven);
  CHECK(v.lowest >= 90);
}
