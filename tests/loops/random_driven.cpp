#include <doctest/doctest.h>

#include <titop/graph/linalg/dense.hpp>

#include "frames.hpp"

/// Random frames (frames.hpp) whose first body moves as an input says: orders and transfers as by
/// M, D and K, where its six coordinates are given.

using namespace loop_test;

namespace {

/// Accelerations from [A; U] at s: q = (what A alone asks for) + (what the joints leave).
MatrixXcd driven(const ByHand& h, Complex s) {
  const by_hand::Structure& a = h.all.a;
  const Rows rows(h.held);
  const MatrixXcd N = rows.motions(), Z = s * s * a.M + s * a.D + a.K;
  MatrixXcd q = MatrixXcd::Zero(a.M.rows(), 12), force = q;
  q.leftCols(6) = rows.motion(MatrixXcd::Identity(h.held.rows(), 6)) / (s * s);
  force.rightCols(6) = a.B.cast<Complex>();
  if (N.cols() > 0)
    q += N * titop::linalg::solve(N.transpose() * Z * N, N.transpose() * (force - Z * q)).z;
  return s * s * (a.C * q);
}

}  // namespace

TEST_CASE("random frames on a body that moves as an input says: as by M, D and K") {
  int compared = 0, twice = 0;
  for (int seed = 3000; seed < 3100; ++seed)
    for (const bool plane : {false, true}) {
      CAPTURE(seed);
      CAPTURE(plane);
      Frame f = Maker{Rng(static_cast<std::uint64_t>(seed)), plane}.make(true);
      f.grounded = false;
      if (f.on_ground()) continue;
      f.grounded = true;
      const ByHand by_hand(f);
      const Left left = left_free(by_hand.all.a, by_hand.held);
      if (!left.clear) continue;
      const titop::System system =
          titop::compile(loop_test::Scene{.f = f, .driven = true}.build(), {.minimize_up_to = 0});
      CHECK(system.order() <= 2 * left.structure.M.rows());
      const std::vector<Complex> s = points({2, 30, 400});
      std::vector<MatrixXcd> exact;
      for (const Complex z : s) exact.push_back(driven(by_hand, z));
      CHECK(by_hand::transfer_error(responses(system, s), exact, 12, 12) <= 1e-8);
      CHECK(by_hand::transfer_error(responses(system.state_space(), s), exact, 12, 12) <= 1e-7);
      ++compared;
      twice += left.twice;
    }
  CHECK(compared >= 50);
  CHECK(twice >= 20);
}
