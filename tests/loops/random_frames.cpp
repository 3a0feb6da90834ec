#include <doctest/doctest.h>

#include "frames.hpp"

/// Random frames (frames.hpp): orders and transfers as by M, D and K on the null space of all that
/// the joints hold.

using namespace loop_test;

namespace {

/// Coordinates that nothing springs back: accelerations do not show them.
Index unsprung(const by_hand::Structure& a) {
  if (a.M.rows() == 0) return 0;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(a.K, a.M, Eigen::EigenvaluesOnly);
  const VectorXd& w2 = modes.eigenvalues();
  return (w2.array() < 1e-9 * std::max(1.0, w2.maxCoeff())).count();
}

struct Counts {
  int compared = 0, twice = 0, loops = 0, beams = 0, still = 0, unsure = 0;
};

void compare(const Frame& f, Counts& count) {
  const ByHand by_hand(f);
  const auto [exact, clear, twice] = left_free(by_hand.all.a, by_hand.held);
  if (!clear) return;
  const titop::Diagram d = Scene{f}.build();
  const titop::System system = titop::compile(d, {.minimize_up_to = 0});
  count.unsure += !(system.certificate().residual <= 1e-9);
  const Index moving = exact.M.rows() - (f.on_ground() ? 0 : 6);
  CHECK(system.order() <= 2 * moving);  // what a clamped hub cuts off is left out
  if (!f.on_ground() && unsprung(exact) == 6) CHECK(system.order() == 2 * moving);
  double largest = 0;
  std::vector<MatrixXcd> by_hand_at;
  const std::vector<Complex> s = points({2, 30, 400});
  for (const Complex z : s)
    if (exact.M.rows() > 0) {
      by_hand_at.push_back(by_hand::accel_transfer(exact, z));
      largest = std::max(largest, by_hand_at.back().cwiseAbs().maxCoeff());
    }
  count.twice += twice;
  count.loops += static_cast<int>(f.joints.size()) - static_cast<int>(f.parts.size()) + 1;
  for (const Part& p : f.parts) count.beams += p.beam;
  if (largest < 1e-12) {  // by hand nothing moves either
    ++count.still;
    for (const MatrixXcd& y : responses(system, s)) CHECK(y.cwiseAbs().maxCoeff() < 1e-12);
    return;
  }
  ++count.compared;
  CHECK(by_hand::transfer_error(responses(system, s), by_hand_at, 12, 6) <= 1e-8);
  CHECK(by_hand::transfer_error(responses(system.state_space(), s), by_hand_at, 12, 6) <= 1e-7);
}

}  // namespace

TEST_CASE("150 frames in space and 150 in a plane: orders and transfers as by M, D and K") {
  Counts count;
  for (int seed = 0; seed < 150; ++seed)
    for (const bool plane : {false, true}) {
      CAPTURE(seed);
      CAPTURE(plane);
      compare(Maker{Rng(static_cast<std::uint64_t>(seed)), plane}.make(false), count);
    }
  CHECK(count.compared >= 150);
  CHECK(count.still >= 20);
  CHECK(count.twice >= 150);
  CHECK(count.loops >= 500);
  CHECK(count.beams >= 200);
  // In one of them the joints leave hardly any motion: all signals of the check are rounding.
  CHECK(count.unsure <= 1);
}

TEST_CASE("such frames with masses on springs and bushings between bodies: as by M, D and K") {
  Counts count;
  for (int seed = 1000; seed < 1100; ++seed)
    for (const bool plane : {false, true}) {
      CAPTURE(seed);
      CAPTURE(plane);
      const Frame f = Maker{Rng(static_cast<std::uint64_t>(seed)), plane}.make(true);
      if (f.hung.empty() && f.cushions.empty()) continue;
      compare(f, count);
    }
  CHECK(count.compared >= 100);
}

TEST_CASE("dense entries that are nothing but rounding are no fault") {
  for (const std::uint64_t seed : {523U, 695U}) {  // of 800, those that show it
    CAPTURE(seed);
    const Frame f = Maker{Rng(seed), true}.make(false);
    const titop::System system = titop::compile(Scene{f}.build(), {.minimize_up_to = 0});
    const titop::FullCertificate c = titop::certify(system);
    CHECK(c.basic.dense_against_factors <= 1e-9);
    CHECK(c.grid.dense <= 1e-8);
  }
}
