// exp(A h) and its integral: against closed forms, and against Taylor's series in 50 digits.
#include <doctest/doctest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <titop/analysis/simulation/hold.hpp>
#include <titop/graph/error.hpp>

#include "support/close.hpp"
#include "support/rng.hpp"

using namespace titop;
using namespace titop_test;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                           boost::multiprecision::et_off>;
using Matrix50 = std::vector<std::vector<Real>>;

/// exp of [[A, B], [0, 0]] h by 2^-k scaling with k far beyond need, in 50 digits.
Matrix50 exponential(const MatrixXd& A, const MatrixXd& B, double h) {
  const auto n = static_cast<std::size_t>(A.rows()), m = n + static_cast<std::size_t>(B.cols());
  const auto product = [m](const Matrix50& a, const Matrix50& b) {
    Matrix50 c(m, std::vector<Real>(m));
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t k = 0; k < m; ++k)
        for (std::size_t j = 0; j < m; ++j) c[i][j] += a[i][k] * b[k][j];
    return c;
  };
  constexpr int halvings = 40;
  Matrix50 X(m, std::vector<Real>(m)), E = X;
  for (std::size_t i = 0; i < m; ++i) {
    E[i][i] = 1;
    for (std::size_t j = 0; j < m && i < n; ++j)
      X[i][j] = Real(j < n ? A(Index(i), Index(j)) : B(Index(i), Index(j - n))) * Real(h) /
                pow(Real(2), halvings);
  }
  Matrix50 term = E;
  for (int k = 1; k <= 12; ++k) {
    term = product(term, X);
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j < m; ++j) E[i][j] += (term[i][j] /= k);
  }
  for (int k = 0; k < halvings; ++k) E = product(E, E);
  return E;
}

}  // namespace

TEST_CASE("hold of an oscillator is sines and cosines") {
  for (const double w : {1e-3, 1.0, 50.0, 1e4})
    for (const double h : {1e-4, 0.01, 1.0}) {
      INFO("omega ", w, ", h ", h);
      const MatrixXd A = (MatrixXd(2, 2) << 0, 1, -w * w, 0).finished();
      const Hold x = hold(A, Eigen::Vector2d(0, 1), h);
      // The argument itself is rounded: by w h ulp.
      const double noise = 1e-15 * std::max(1.0, w * h);
      const double c = std::cos(w * h), s = std::sin(w * h), half = std::sin(w * h / 2);
      CHECK(std::abs(x.A(0, 0) - c) <= noise);
      CHECK(std::abs(x.A(0, 1) - s / w) <= noise / w);
      CHECK(std::abs(x.A(1, 0) + w * s) <= noise * w);
      CHECK(std::abs(x.B(0, 0) - 2 * half * half / (w * w)) <= noise / (w * w));
      CHECK(std::abs(x.B(1, 0) - s / w) <= noise / w);
    }
}

TEST_CASE("hold of a free mass is exact") {
  const Hold x = hold((MatrixXd(2, 2) << 0, 1, 0, 0).finished(), Eigen::Vector2d(0, 1), 0.25);
  CHECK(x.A == (MatrixXd(2, 2) << 1, 0.25, 0, 1).finished());
  CHECK(x.B == Eigen::Vector2d(0.03125, 0.25));
}

TEST_CASE("hold of any matrix against 50 digits") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    INFO("seed ", seed);
    Rng rng(seed);
    MatrixXd A(5, 5), B(5, 2);
    for (Index i = 0; i < 5; ++i) {
      for (Index j = 0; j < 5; ++j) A(i, j) = rng.between(-1, 1) * std::pow(10.0, double(i - j));
      A(i, i) -= 2;
      for (Index j = 0; j < 2; ++j) B(i, j) = rng.between(-1, 1) * std::pow(10.0, double(i));
    }
    const double h = seed == 4 ? 40 : 0.3;
    const Hold x = hold(A, B, h);
    const Matrix50 exact = exponential(A, B, h);
    // Decayed entries are accurate relative to the initial ones, not relative to themselves.
    for (Index i = 0; i < 5; ++i)
      for (Index j = 0; j < 7; ++j) {
        const auto expected = exact[std::size_t(i)][std::size_t(j)].convert_to<double>();
        const double found = j < 5 ? x.A(i, j) : x.B(i, j - 5);
        const double size = std::pow(10.0, double(j < 5 ? i - j : i));
        CHECK(std::abs(found - expected) <= 1e-15 * size);
      }
  }
}

TEST_CASE("hold of slow states beside fast ones keeps the digits of both") {
  const double fast = 1e6, slow = 1e-9;
  // Uncoupled: a decay, an oscillator of 1e6 rad/s, a free mass.
  MatrixXd A = MatrixXd::Zero(5, 5);
  A(0, 0) = -slow;
  A(1, 3) = 1, A(3, 1) = -fast * fast;
  A(2, 4) = 1;
  MatrixXd B = MatrixXd::Zero(5, 1);
  B << 1, 0, 0, 1, 1;
  const Hold x = hold(A, B, 1);
  CHECK(std::abs(x.B(0, 0) * slow / -std::expm1(-slow) - 1) <= 1e-15);
  CHECK(x.A(2, 4) == 1);
  CHECK(x.B(2, 0) == 0.5);
  CHECK(std::abs(x.A(1, 1) - std::cos(fast)) <= 1e-12);
  // A soft spring of two masses that a stiff one connects: x1 + x2 moves as cos(t), x1 - x2 at
  // sqrt(1 + 2e12) rad/s, of which the square costs 2e12 ulp of long double.
  MatrixXd K(2, 2);
  K << 1 + 1e12, -1e12, -1e12, 1 + 1e12;
  MatrixXd two = MatrixXd::Zero(4, 4);
  two.topRightCorner(2, 2).setIdentity();
  two.bottomLeftCorner(2, 2) = -K;
  const MatrixXd both = hold(two, Eigen::Vector4d(0, 0, 1, 1), 1).A;
  CHECK(std::abs(both(0, 0) + both(0, 1) - std::cos(1.0)) <= 3e-7);
}

TEST_CASE("hold of a row of 70 masses, in double, against its modes") {
  const Index n = 70;
  MatrixXd K = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    K(i, i) = 2;
    if (i > 0) K(i, i - 1) = K(i - 1, i) = -1;
  }
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n), B = MatrixXd::Zero(2 * n, 1);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -K;
  B(n) = 1;
  const Hold x = hold(A, B, 3);  // 140 states, coupled: in double
  // Modes of the row: frequencies 2 sin(j p / 2), shapes sin(i j p), p = pi / (n + 1).
  const double p = std::acos(-1.0) / static_cast<double>(n + 1);
  double position = 0, rate = 0;
  for (Index j = 1; j <= n; ++j) {
    const double shape = std::sin(static_cast<double>(j) * p),
                 w = 2 * std::sin(static_cast<double>(j) * p / 2), half = std::sin(1.5 * w);
    position += 2 / static_cast<double>(n + 1) * shape * shape * 2 * half * half / (w * w);
    rate += 2 / static_cast<double>(n + 1) * shape * shape * std::sin(3 * w) / w;
  }
  CHECK(std::abs(x.B(0, 0) - position) <= 1e-13);
  CHECK(std::abs(x.B(n, 0) - rate) <= 1e-13);
}

TEST_CASE("hold of nothing: no states, no inputs, neither") {
  for (const Index n : {0, 2})
    for (const Index m : {0, 3}) {
      const Hold x = hold(MatrixXd::Zero(n, n), MatrixXd::Zero(n, m), 0.5);
      CHECK(x.A == MatrixXd::Identity(n, n));
      CHECK(x.B == MatrixXd::Zero(n, m));
      CHECK(x.B.cols() == m);
    }
}

TEST_CASE("held response of a mass, and refusals") {
  const StateSpace mass{(MatrixXd(2, 2) << 0, 1, 0, 0).finished(),
                        Eigen::Vector2d(0, 0.5),
                        Eigen::RowVector2d(1, 0),
                        MatrixXd::Zero(1, 1),
                        {"x", "v"},
                        {"u"},
                        {"y"}};
  const MatrixXd y = held_response(mass, 2.0, Eigen::RowVector3d(1, -1, 0));
  CHECK(y == Eigen::RowVector3d(0, 1, 2));  // a t^2 / 2 with a = u / 2; then it stops
  for (const double h : {0.0, -1.0, HUGE_VAL, std::nan("")})
    CHECK_THROWS_AS(hold(mass.A, mass.B, h), Error);
  CHECK_THROWS_AS(held_response(mass, 1.0, MatrixXd::Zero(2, 3)), Error);
}
