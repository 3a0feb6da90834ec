#include <doctest/doctest.h>

#include "block_error.hpp"
#include "frame_by_hand.hpp"
#include "frame_diagram.hpp"

/// Random frames (frames.hpp) whose first body has an acceleration input: orders and transfers as
/// by M, D and K, where its six coordinates are given.

using namespace loops_test;

namespace {

/// Tolerance of an output port by an input port, relative to the largest entry of both; limited as
/// in random_frames.cpp by rounding of stiff beams next to soft springs. A dense model keeps a
/// digit less.
constexpr double kTolerance = 1e-8;
/// Relative to the largest entry of all ports: lower limit of a port's scale, as in
/// random_frames.cpp. The largest is about 1: motion along with the first body, or 1 / mass.
constexpr double kWeak = 1e-3;

/// Accelerations from [A; U] at s: q = (motion imposed by A) + (motion that the joints allow).
MatrixXcd driven(const FrameByHand& h, const Constraints& constraints, Complex s) {
  const by_hand::Structure& a = h.all.a;
  MatrixXcd given = MatrixXcd::Zero(a.M.rows(), 12), force = given;
  given.leftCols(6) =
      constraints.motion(MatrixXd::Identity(h.held.rows(), 6)).cast<Complex>() / (s * s);
  force.rightCols(6) = a.B.cast<Complex>();
  return s * s * (a.C * constrained_motion(a, constraints, s, force, given).q);
}

}  // namespace

TEST_CASE("random frames on a body of prescribed motion: as by M, D and K") {
  int compared = 0, redundant = 0;
  for (int seed = 3000; seed < 3100; ++seed)
    for (const bool plane : {false, true}) {
      CAPTURE(seed);
      CAPTURE(plane);
      Frame f = random_frame(seed, plane, true);
      f.grounded = false;
      if (f.on_ground()) continue;
      f.grounded = true;
      const FrameByHand by_hand(f);
      const Constraints constraints(by_hand.held);
      if (!constraints.clear) continue;
      const titop::System system =
          titop::compile(diagram_of({.frame = f, .driven = true}), {.minimize_up_to = 0});
      CHECK(system.order() <= 2 * constraints.motions().cols());
      const std::vector<Complex> s = points({2, 30, 400});
      std::vector<MatrixXcd> exact;
      for (const Complex z : s) exact.push_back(driven(by_hand, constraints, z));
      CHECK(block_error(responses(system, s), exact, 6, 6, kWeak) <= kTolerance);
      CHECK(block_error(responses(system.state_space(), s), exact, 6, 6, kWeak) <= 10 * kTolerance);
      ++compared;
      redundant += constraints.redundant();
    }
  CHECK(compared >= 50);
  CHECK(redundant >= 20);
}
