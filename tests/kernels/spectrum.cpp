#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/spectral.hpp>

#include "support/rng.hpp"

/// Poles in clusters: A V = V T and W V = 1, however A is made.

using namespace titop;
using namespace titop_test;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

constexpr double kBound = 1e4;

MatrixXd random_orthogonal(Rng& rng, Index n) {
  return n == 0 ? MatrixXd(0, 0)
                : MatrixXd(Eigen::HouseholderQR<MatrixXd>(rng.matrix(n, n)).householderQ());
}

/// Laws of any spectrum; the residuals relative to the sizes of the factors.
void check(const MatrixXd& A, const linalg::Spectrum& s) {
  const Index n = A.rows();
  REQUIRE(s.V.cols() == n);
  Index next = 0;
  MatrixXcd T = MatrixXcd::Zero(n, n);
  for (const auto& [first, count, simple] : s.clusters) {
    REQUIRE(first == next);
    next += count;
    T.block(first, first, count, count) = s.T.block(first, first, count, count);
    CHECK((!simple || count <= 2));
    CHECK((!simple || MatrixXcd(s.T.block(first, first, count, count)).isDiagonal(0)));
    // Closed under conjugation: so are the trace, and the part of the identity that belongs to it.
    CHECK(s.values.segment(first, count).sum().imag() == 0);
    const MatrixXcd P = s.V.middleCols(first, count) * s.W.middleRows(first, count);
    CHECK(P.imag().norm() <= 1e-13 * double(n) * s.V.norm() * s.W.norm());
  }
  CHECK(next == n);
  if (n == 0) return;
  CHECK(T == s.T);
  CHECK(T.isUpperTriangular(0));
  CHECK((A * s.V - s.V * T).norm() <= 1e-14 * double(n) * A.norm() * s.V.norm());
  CHECK((s.W * s.V - MatrixXcd::Identity(n, n)).norm() <=
        1e-14 * double(n) * s.W.norm() * s.V.norm());
}

}  // namespace

TEST_CASE("spectrum: random, scaled and permuted matrices of 0 to 12 rows") {
  Rng rng(4711);
  for (Index n = 0; n <= 12; ++n)
    for (const double spread : {0.0, 3.0}) {
      CAPTURE(n);
      MatrixXd A = rng.matrix(n, n);
      for (Index i = 0; i < n; ++i) {
        const double d = std::exp2(spread * rng.between(-1, 1));
        A.row(i) *= d, A.col(i) /= d;
      }
      check(A, linalg::spectrum(A, kBound));
      check(A, linalg::spectrum(A, 2));  // few poles are separated
      check(A.transpose() * A, linalg::spectrum(A.transpose() * A, kBound));
      const MatrixXd singular = n ? MatrixXd(A.col(0) * A.row(0)) : A;
      check(singular, linalg::spectrum(singular, kBound));
    }
}

TEST_CASE("spectrum: multiple poles with one vector stay together, others apart") {
  Rng rng(815);
  for (const Index k : {2, 3, 4})
    for (int others = 0; others <= 6; others += 2) {
      CAPTURE(k);
      CAPTURE(others);
      const Index n = k + others;
      // A Jordan block at -1, and pairs at -0.1 +- 2j, 4j, ...
      MatrixXd J = MatrixXd::Zero(n, n);
      J.topLeftCorner(k, k).diagonal().setConstant(-1);
      J.topLeftCorner(k, k).diagonal(1).setOnes();
      for (Index i = k; i < n; i += 2)
        J.block(i, i, 2, 2) << -0.1, double(i - k + 2), -double(i - k + 2), -0.1;
      const MatrixXd Q = random_orthogonal(rng, n), A = Q * J * Q.transpose();
      const linalg::Spectrum s = linalg::spectrum(A, kBound);
      check(A, s);
      CHECK(std::ssize(s.clusters) == 1 + others / 2);
      for (const auto& [first, count, simple] : s.clusters) {
        const bool jordan = std::abs(s.values(first) + 1.0) < 0.1;
        CHECK(count == (jordan ? k : 2));
        CHECK(simple == !jordan);
        if (jordan)  // a multiple pole moves far by rounding, the mean of them does not
          CHECK(std::abs(s.values.segment(first, count).mean() + 1.0) <= 1e-13);
      }
    }
}

TEST_CASE("spectrum: critical damping is no pair of vectors, a zero matrix one pole") {
  const MatrixXd critical{{0, 1}, {-25, -10}};
  const linalg::Spectrum s = linalg::spectrum(critical, kBound);
  check(critical, s);
  REQUIRE(s.clusters.size() == 1);
  CHECK(!s.clusters[0].simple);
  const MatrixXd zero = MatrixXd::Zero(3, 3);
  check(zero, linalg::spectrum(zero, kBound));
  CHECK(linalg::spectrum(zero, kBound).values.isZero(0));
  // A pair turned by 90 degrees has vectors at right angles.
  const MatrixXd turned{{0, 2}, {-2, 0}};
  CHECK(linalg::spectrum(turned, kBound).clusters[0].simple);
  CHECK(std::abs(linalg::spectrum(turned, kBound).values(0) - std::complex<double>(0, 2)) <= 1e-15);
}
