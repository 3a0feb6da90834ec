#include <doctest/doctest.h>

#include "block_error.hpp"
#include "frame_by_hand.hpp"
#include "frame_diagram.hpp"

/// Random frames (frames.hpp): orders and transfers as by M, D and K on the null space of all joint
/// constraints.

using namespace loops_test;

namespace {

/// Tolerance of an output port by an input port, relative to the largest entry of both. The limit
/// is rounding of beams up to 1e9 N/m stiff next to springs of 20 N/m: 1e-16 x 1e9 / 20. A dense
/// model loses one more digit.
constexpr double kTolerance = 1e-8;
/// Relative to the largest entry of all ports: lower limit of a port's scale. Times the tolerance
/// this is 1e-11, the motion by rounding (1e-15) under a constraint of 1e-4 of the others
/// (Constraints::clear).
constexpr double kWeak = 1e-3;

/// Coordinates without stiffness: accelerations do not depend on them.
Index unsprung(const by_hand::Structure& a) {
  if (a.M.rows() == 0) return 0;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(a.K, a.M, Eigen::EigenvaluesOnly);
  const VectorXd& w2 = modes.eigenvalues();
  return (w2.array() < 1e-9 * std::max(1.0, w2.maxCoeff())).count();
}

struct Counts {
  int compared = 0, redundant = 0, loops = 0, beams = 0, still = 0, unsure = 0;
};

void compare(const Frame& f, Counts& count) {
  const FrameByHand by_hand(f);
  const Constraints constraints(by_hand.held);
  if (!constraints.clear) return;
  const by_hand::Structure& whole = by_hand.all.a;
  const by_hand::Structure exact = constrained(whole, constraints);
  const titop::Diagram d = diagram_of({f});
  const titop::System system = titop::compile(d, {.minimize_up_to = 0});
  count.unsure += !(system.certificate().residual <= 1e-9);
  const Index moving = exact.M.rows() - (f.on_ground() ? 0 : 6);
  CHECK(system.order() <= 2 * moving);  // parts beyond a clamped hub are left out
  if (!f.on_ground() && unsprung(exact) == 6) CHECK(system.order() == 2 * moving);
  const MatrixXcd force = whole.B.cast<Complex>();
  const MatrixXcd still = MatrixXcd::Zero(whole.M.rows(), force.cols());
  double largest = 0;
  std::vector<MatrixXcd> by_hand_at;
  const std::vector<Complex> s = points({2, 30, 400});
  for (const Complex z : s) {
    const MatrixXcd q = constrained_motion(whole, constraints, z, force, still).q;
    by_hand_at.push_back(z * z * (whole.C * q));
    largest = std::max(largest, by_hand_at.back().cwiseAbs().maxCoeff());
  }
  count.redundant += constraints.redundant();
  count.loops += static_cast<int>(f.joints.size()) - static_cast<int>(f.bodies.size()) + 1;
  for (const Frame::Body& b : f.bodies) count.beams += b.beam;
  if (largest < 1e-12) {  // by hand nothing moves either
    ++count.still;
    for (const MatrixXcd& y : responses(system, s)) CHECK(y.cwiseAbs().maxCoeff() < 1e-12);
    return;
  }
  ++count.compared;
  CHECK(block_error(responses(system, s), by_hand_at, 6, 6, kWeak) <= kTolerance);
  CHECK(block_error(responses(system.state_space(), s), by_hand_at, 6, 6, kWeak) <=
        10 * kTolerance);
}

}  // namespace

TEST_CASE("150 frames in space and 150 in a plane: orders and transfers as by M, D and K") {
  Counts count;
  for (int seed = 0; seed < 150; ++seed)
    for (const bool plane : {false, true}) {
      CAPTURE(seed);
      CAPTURE(plane);
      compare(random_frame(seed, plane, false), count);
    }
  CHECK(count.compared >= 150);
  CHECK(count.still >= 20);
  CHECK(count.redundant >= 150);
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
      const Frame f = random_frame(seed, plane, true);
      if (f.spring_masses.empty() && f.bushings.empty()) continue;
      compare(f, count);
    }
  CHECK(count.compared >= 100);
}

TEST_CASE("dense entries that are nothing but rounding are no fault") {
  for (const int seed : {523, 695}) {  // of 800, those affected
    CAPTURE(seed);
    const Frame f = random_frame(seed, true, false);
    const titop::System system = titop::compile(diagram_of({f}), {.minimize_up_to = 0});
    const titop::FullCertificate c = titop::certify(system);
    CHECK(c.basic.dense_against_factors <= 1e-9);
    CHECK(c.grid.dense <= 1e-8);
  }
}
