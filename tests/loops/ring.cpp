#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "assembly.hpp"

/// A ring of eight beams welded to itself, free in space.

using namespace loop_test;
using namespace titop;

namespace {

constexpr int kBeams = 8;
const Tube kTube{1, 0.05, 0.04, 4};

/// The turn from one beam to the next.
const Eigen::AngleAxisd kTurn{2 * pi / kBeams, Vector3d::UnitZ()};

by_hand::Structure ring_by_hand() {
  const Index inner = 6 * (kTube.elements - 1), corners = 6 * kBeams;
  Assembly r(corners + kBeams * inner, 6, 12);
  const by_hand::Beam beam = kTube.numbers();
  // Corner i is where beam i begins, in that beam's frame.
  const by_hand::Matrix6 T = by_hand::dual(kTurn.toRotationMatrix());
  for (Index i = 0; i < kBeams; ++i)
    r.beam(beam, r.unit(6 * i, 6), T * r.unit(6 * ((i + 1) % kBeams), 6), corners + i * inner);
  r.a.C.topRows(6) = r.unit(6 * 5, 6);
  r.a.C.bottomRows(6) = r.unit(6 * 2, 6);
  r.a.B = (r.unit(6 * 2, 6)).transpose();
  return r.a;
}

Diagram ring(int first) {
  Diagram d{"ring"};
  const FlexibleBody body = kTube.beam();
  std::vector<BodyHandle> b;
  b.reserve(kBeams);
  for (int i = 0; i < kBeams; ++i) b.push_back(d.add("b" + std::to_string(i), body));
  const Rotation T = Rotation::about({0, 0, 1}, kTurn.angle());
  for (int i = 0; i < kBeams; ++i) {
    const int k = (i + first) % kBeams;  // which equation stands where must not matter
    mount(b[static_cast<std::size_t>((k + 1) % kBeams)], b[static_cast<std::size_t>(k)].child, T);
  }
  b[1].child.force += T * d.input("U", 6);
  d.output("a5", 6) = b[5].parent.accel;
  d.output("a2", 6) = b[2].parent.accel;
  return d;
}

}  // namespace

TEST_CASE("ring of eight flexible beams, free: order 372, poles as the whole ring's M and K") {
  const System system = compile(ring(0));
  const by_hand::Structure a = ring_by_hand();
  CHECK(system.state_space().order() == 372);
  const auto poles = all_poles(system);
  CHECK(by_hand::pole_error(poles, elastic_poles(a, 6)) <= 1e-8);
  const auto s = points({30, 200, 900, 4000, 30000});
  std::vector<MatrixXcd> exact;
  for (const Complex z : s) exact.push_back(by_hand::accel_transfer(a, z));
  CHECK(error_3(responses(system, s), exact) <= 1e-9);
  CHECK(error_3(responses(system.state_space(), s), exact) <= 1e-8);
  CHECK(compile(ring(3)).states() == system.states());
}
