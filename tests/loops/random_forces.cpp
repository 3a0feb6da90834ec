#include <doctest/doctest.h>

#include <titop/graph/linalg/dense.hpp>

#include "frames.hpp"

/// Random frames (frames.hpp) of which the wrench at one joint is read: as by Lagrange multipliers,
/// or refused where they are not determined.

using namespace loop_test;
using namespace titop;

namespace {

/// The wrench at s of the body that joint k hangs on what it hangs on, in the body's frame, per
/// unit input: the multipliers of the joint's rows and its springs, on the body's own coordinates.
MatrixXcd wrench(const ByHand& h, const Rows& rows, int k, Complex s) {
  const by_hand::Structure& a = h.all.a;
  const MatrixXcd Z = s * s * a.M + s * a.D + a.K, B = a.B.cast<Complex>(), N = rows.motions();
  MatrixXcd q = MatrixXcd::Zero(a.M.rows(), B.cols());
  if (N.cols() > 0) q = N * linalg::solve(N.transpose() * Z * N, N.transpose() * B).z;
  const MatrixXcd lambda = rows.multipliers(B - Z * q);
  const ByHand::Parts& p = h.parts[at(k)];
  const Eigen::VectorXcd spring = p.stiffness.cast<Complex>() * (1.0 + kDamping * s);
  const MatrixXcd on_all =
      h.held.middleRows(p.first, p.count).transpose() * lambda.middleRows(p.first, p.count) +
      p.q.transpose() * (spring.asDiagonal() * (p.q * q));
  return on_all.middleRows(h.first[at(h.f.joints[at(k)].a)], 6);
}

struct Counts {
  int compared = 0, refused = 0;
};

void compare(const Frame& f, int read, Counts& count) {
  const ByHand by_hand(f);
  const Rows rows(by_hand.held);
  if (!rows.clear) return;
  const MatrixXd open = rows.open();
  const ByHand::Parts& p = by_hand.parts[at(read)];
  const double off = open.cols() && p.count ? open.middleRows(p.first, p.count).norm() : 0;
  if (off > 1e-11 && off < 1e-3) return;
  const Diagram d = loop_test::Scene{f, read}.build();
  try {
    const System system = compile(d, {.minimize_up_to = 0});
    CHECK(off < 1e-11);
    for (const Complex s : points({2, 30, 400})) {
      const MatrixXcd exact = wrench(by_hand, rows, read, s), G = system.transfer(s).bottomRows(6);
      CHECK((G - exact).cwiseAbs().maxCoeff() <= 1e-7 * std::max(1.0, exact.cwiseAbs().maxCoeff()));
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
      const Frame f = Maker{Rng(static_cast<std::uint64_t>(seed)), plane}.make(true);
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
