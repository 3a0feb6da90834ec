#include <doctest/doctest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <titop/titop.hpp>

#include "support/alone.hpp"
#include "support/rng.hpp"

/// Certificates of right models given as one dense Lti.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop_test::alone;
using titop_test::Rng;

namespace {

/// A building of eight floors, three motions each, as [Chahlaoui, Van Dooren, SLICOT Working Note
/// 2002-2] has one: its natural frequencies [rad/s] and its damping, a + b omega^2, in random
/// shapes; force on one coordinate to the rate of the same one.
Lti building() {
  VectorXd omega(24);
  omega << 5.23624, 5.89811, 7.64117, 13.4829, 14.2364, 17.5623, 24.5152, 26.4576, 30.7733, 35.3835,
      37.934, 43.1047, 44.5195, 46.669, 52.6024, 54.8997, 57.21, 58.1808, 61.0327, 64.7996, 69.1521,
      72.2841, 74.9998, 89.6941;
  const Index n = omega.size();
  Rng rng(48);
  const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(rng.matrix(n, n)).householderQ();
  const VectorXd k = omega.cwiseAbs2(), c = (0.4948 + 1.056e-3 * k.array()).matrix();
  Lti m{MatrixXd::Zero(2 * n, 2 * n), MatrixXd::Zero(2 * n, 1), MatrixXd::Zero(1, 2 * n), {}};
  m.A.topRightCorner(n, n).setIdentity();
  m.A.bottomLeftCorner(n, n) = -Q * k.asDiagonal() * Q.transpose();
  m.A.bottomRightCorner(n, n) = -Q * c.asDiagonal() * Q.transpose();
  m.B(n, 0) = m.C(0, n) = 1;
  return m;
}

/// Poles -p in companion form, force on the last state, the first one read.
Lti companion(const std::vector<double>& p) {
  const auto n = static_cast<Index>(p.size());
  VectorXd a = VectorXd::Zero(n + 1);  // of s^0, s^1, ...
  a(0) = 1;
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 1; j >= 0; --j)
      a(j) = p[static_cast<std::size_t>(i)] * a(j) + (j > 0 ? a(j - 1) : 0);
  Lti m{MatrixXd::Zero(n, n), MatrixXd::Zero(n, 1), MatrixXd::Zero(1, n), {}};
  m.A.topRightCorner(n - 1, n - 1).setIdentity();
  m.A.bottomRows(1) = -a.head(n).transpose();
  m.B(n - 1, 0) = m.C(0, 0) = 1;
  return m;
}

}  // namespace

TEST_CASE("certificate of a building of 48 states: no fault, and all of them count") {
  const System system = compile(alone(building()));
  const FullCertificate c = certify(system);
  CAPTURE(to_string(c));
  CHECK(c.holds());
  CHECK(c.order.lowest <= 48);
  CHECK(c.order.highest >= 48);
  CHECK(system.state_space().order() == 48);
}

TEST_CASE("certificate of lags of which three are nearly one, in companion form: no fault") {
  const std::vector<double> slow{1e-4, 1.01e-4, 1.02e-4, 1, 30};
  std::vector<double> fast;
  for (const double p : slow) fast.push_back(1 / p);
  for (const auto& poles : {slow, fast}) {
    const System system = compile(alone(companion(poles)));
    const FullCertificate c = certify(system);
    CAPTURE(to_string(c));
    CHECK(c.holds());
    CHECK(c.order.lowest <= 5);
    CHECK(c.order.highest >= 5);
    for (const double omega : {1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4}) {
      const std::complex<double> s(0, omega);
      std::complex<double> exact = 1;
      for (const double p : poles) exact /= s + p;
      CHECK(std::abs(system.transfer(s)(0, 0) - exact) <= 1e-11 * std::abs(exact));
    }
  }
}
