#include <doctest/doctest.h>

#include "block_error.hpp"
#include "frame_by_hand.hpp"
#include "frame_diagram.hpp"

/// Random frames (frames.hpp) of which the wrench at one joint is read: as by Lagrange multipliers,
/// or refused if they are not determined.

using namespace loops_test;
using namespace titop;

namespace {

/// Tolerance of forces by forces, forces by torques ..., each relative to the largest of its kind.
/// The limit is a multiplier of nearly redundant constraints (Constraints::clear: up to 1e4 times
/// the others), next to beams up to 1e9 N/m stiff.
constexpr double kTolerance = 1e-7;
/// Relative to the largest kind, or to 1 (a unit force, an arm of a metre): lower limit of a kind's
/// scale. Times the tolerance this is 1e-8, the force of a beam by rounding (1e-16 of a motion of
/// 0.1 m/N, times 1e9 N/m) if its true force is 0.
constexpr double kWeak = 0.1;

/// The wrench at s of the body that joint k carries on its parent, in the body's frame, per unit
/// input: the multipliers of the joint's rows and its springs, on the body's own coordinates.
MatrixXcd wrench(const FrameByHand& h, const Constraints& constraints, int k, Complex s) {
  const by_hand::Structure& a = h.all.a;
  const MatrixXcd force = a.B.cast<Complex>();
  const MatrixXcd still = MatrixXcd::Zero(a.M.rows(), force.cols());
  const auto [q, borne] = constrained_motion(a, constraints, s, force, still);
  const MatrixXcd lambda = constraints.multipliers(borne);
  const FrameByHand::JointRows& j = h.joints[at(k)];
  const Eigen::VectorXcd spring = j.stiffness.cast<Complex>() * (1.0 + kDamping * s);
  const MatrixXcd on_all =
      h.held.middleRows(j.first, j.count).transpose() * lambda.middleRows(j.first, j.count) +
      j.stretch.transpose() * (spring.asDiagonal() * (j.stretch * q));
  return on_all.middleRows(h.first[at(h.f.joints[at(k)].a)], 6);
}

struct Counts {
  int compared = 0, refused = 0;
};

void compare(const Frame& f, int read, Counts& count) {
  const FrameByHand by_hand(f);
  const Constraints constraints(by_hand.held);
  if (!constraints.clear) return;
  const MatrixXd open = constraints.open();
  const FrameByHand::JointRows& j = by_hand.joints[at(read)];
  const double off = open.cols() && j.count ? open.middleRows(j.first, j.count).norm() : 0;
  if (off > 1e-11 && off < 1e-3) return;
  const Diagram d = diagram_of({.frame = f, .read = read});
  try {
    const System system = compile(d, {.minimize_up_to = 0});
    CHECK(off < 1e-11);
    for (const Complex s : points({2, 30, 400})) {
      CAPTURE(s.imag());
      const MatrixXcd exact = wrench(by_hand, constraints, read, s);
      const MatrixXcd G = system.transfer(s).bottomRows(6);
      CHECK(block_error({G}, {exact}, 3, 3, kWeak, 1) <= kTolerance);
    }
    ++count.compared;
  } catch (const Error& error) {
    CAPTURE(error.what());
    CHECK(error.has(Code::kinematic_loop));
    CHECK(off > 1e-3);
    ++count.refused;
  }
}

}  // namespace

TEST_CASE(
    "the wrench at a joint of a random frame: as by multipliers, refused where these are open") {
  Counts count;
  for (int seed = 2000; seed < 2100; ++seed)
    for (const bool plane : {false, true}) {
      CAPTURE(seed);
      CAPTURE(plane);
      const Frame f = random_frame(seed, plane, true);
      std::vector<int> hang;
      for (int k = 0; k < static_cast<int>(f.joints.size()); ++k)
        if (!f.joints[at(k)].closes) hang.push_back(k);
      const int read = hang[at(seed % static_cast<int>(hang.size()))];
      CAPTURE(read);
      compare(f, read, count);
    }
  CHECK(count.compared >= 50);
  CHECK(count.refused >= 20);
}
