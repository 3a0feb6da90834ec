#include <doctest/doctest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <titop/analysis/reduction/gramians.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/schur.hpp>

#include "support/close.hpp"
#include "support/rng.hpp"

/// Gramians, Hankel singular values and the split before them, against theory and 50 digits.
using namespace titop;
using namespace titop_test;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

namespace {

/// Every pole at least 0.05 left of the axis.
MatrixXd random_stable(Rng& rng, Index n) {
  MatrixXd A = rng.matrix(n, n);
  A.diagonal().array() -= A.eigenvalues().real().maxCoeff() + rng.between(0.05, 1);
  return A;
}

/// A P + P A' + B B' = 0 as n^2 linear equations, by elimination with pivoting in 50 digits.
MatrixXd gramian_by_kronecker(const MatrixXd& A, const MatrixXd& B) {
  using Digits50 = boost::multiprecision::cpp_bin_float_50;
  const Index n = A.rows();
  const auto size = static_cast<std::size_t>(n * n);
  std::vector<std::vector<Digits50>> E(size, std::vector<Digits50>(size + 1, Digits50(0)));
  const auto row = [&](Index i, Index j) { return static_cast<std::size_t>(i * n + j); };
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      for (Index k = 0; k < n; ++k) {
        E[row(i, j)][row(k, j)] += Digits50(A(i, k));
        E[row(i, j)][row(i, k)] += Digits50(A(j, k));
      }
      for (Index k = 0; k < B.cols(); ++k)
        E[row(i, j)][size] -= Digits50(B(i, k)) * Digits50(B(j, k));
    }
  for (std::size_t k = 0; k < size; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < size; ++i)
      if (abs(E[i][k]) > abs(E[pivot][k])) pivot = i;
    std::swap(E[k], E[pivot]);
    for (std::size_t i = 0; i < size; ++i) {
      if (i == k) continue;
      const Digits50 f = E[i][k] / E[k][k];
      for (std::size_t j = k; j <= size; ++j) E[i][j] -= f * E[k][j];
    }
  }
  MatrixXd P(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      P(i, j) = static_cast<double>(E[row(i, j)][size] / E[row(i, j)][row(i, j)]);
  return P;
}

StateSpace model(MatrixXd A, MatrixXd B, MatrixXd C) {
  StateSpace m;
  m.D = MatrixXd::Zero(C.rows(), B.cols());
  m.A = std::move(A), m.B = std::move(B), m.C = std::move(C);
  return m;
}

/// Both ports of size 1.
VectorXd hankel(const StateSpace& m) {
  return detail::balance(detail::split(m), {VectorXd::Ones(m.B.cols()), VectorXd::Ones(m.C.rows())})
      .sigma;
}

Complex sum(const detail::Split& s, const StateSpace& m, Complex at) {
  Complex H = m.D(0, 0);
  for (const detail::SpectralPart* p : {&s.integrals, &s.kept, &s.stable}) {
    if (p->order() == 0) continue;
    const MatrixXcd S = at * MatrixXcd::Identity(p->order(), p->order()) - p->A.cast<Complex>();
    H += (p->C * S.partialPivLu().solve(p->B.cast<Complex>()))(0, 0);
  }
  return H;
}

}  // namespace

TEST_CASE("the complex Schur form: A = Q T Q^H, and eigenvalues come to the front as asked") {
  Rng rng(3);
  for (const Index n : {1, 2, 5, 12}) {
    const MatrixXd A = rng.matrix(n, n);
    linalg::Schur s = linalg::schur(A);
    std::vector<char> first;
    for (Index i = 0; i < n; ++i) first.push_back(s.T(i, i).real() < 0);
    const auto count = std::count(first.begin(), first.end(), 1);
    const auto check = [&] {
      CHECK((s.Q * s.T * s.Q.adjoint() - A.cast<Complex>()).norm() <= 1e-13 * A.norm() * 10);
      CHECK((s.Q.adjoint() * s.Q - MatrixXcd::Identity(n, n)).norm() <= 1e-13 * 10);
      CHECK(s.T.isUpperTriangular(0));
    };
    check();
    linalg::reorder(s, first);
    check();
    for (Index i = 0; i < n; ++i) CHECK((s.T(i, i).real() < 0) == (i < count));
  }
}

TEST_CASE("Gramians by Hammarling's method are those of n^2 equations in 50 digits") {
  Rng rng(5);
  for (const Index n : {1, 3, 6}) {
    const MatrixXd A = random_stable(rng, n), B = rng.matrix(n, 2);
    const linalg::Schur s = linalg::schur(A);
    const MatrixXcd F = s.Q * linalg::lyapunov_factor(s.T, s.Q.adjoint() * B.cast<Complex>());
    const MatrixXd exact = gramian_by_kronecker(A, B);
    CHECK((F * F.adjoint() - exact.cast<Complex>()).norm() <= 1e-12 * exact.norm());
  }
}

TEST_CASE("Hankel singular values that theory knows") {
  // c b / (s + a): |c b| / 2a.
  const auto one = [](double x) { return MatrixXd::Constant(1, 1, x); };
  CHECK(relative(hankel(model(one(-4), one(3), one(-2)))(0), 6.0 / 8.0) <= 1e-14);
  // Two of them side by side, c_i b_i = r_i: eigenvalues of [r_1 / 2p_1, g; g, r_2 / 2p_2] with
  // g = sqrt(r_1 r_2) / (p_1 + p_2), since both Gramians are that matrix.
  const double p1 = 1, p2 = 7, r1 = 2, r2 = 5;
  const VectorXd root{{std::sqrt(r1), std::sqrt(r2)}};
  const VectorXd two = hankel(model(VectorXd{{-p1, -p2}}.asDiagonal().toDenseMatrix(),
                                    MatrixXd(root), MatrixXd(root.transpose())));
  const double a = r1 / (2 * p1), b = r2 / (2 * p2), g = root.prod() / (p1 + p2);
  const double half = std::sqrt((a - b) * (a - b) / 4 + g * g);
  CHECK(relative(two(0), (a + b) / 2 + half) <= 1e-13);
  CHECK(relative(two(1), (a + b) / 2 - half) <= 1e-13);
  // An all-pass of any degree has all of them 1 [Glover 1984]: (p - s) / (p + s) in series, each
  // -1 + 2p / (s + p).
  const std::vector<double> poles{0.3, 1, 5, 11};
  MatrixXd A = MatrixXd::Zero(4, 4), B(4, 1), C(1, 4);
  double through = 1;  // of the sections before
  for (Index k = 0; k < 4; ++k) {
    const double p = poles[static_cast<std::size_t>(k)];
    B(k, 0) = through;
    for (Index j = 0; j < k; ++j) A(k, j) = C(0, j);
    A(k, k) = -p;
    C.leftCols(k) *= -1;
    C(0, k) = 2 * p;
    through *= -1;
  }
  const VectorXd all = hankel(model(A, B, C));
  REQUIRE(all.size() == 4);
  for (const double sigma : all) CHECK(relative(sigma, 1.0) <= 1e-13);
}

TEST_CASE("integrals, poles on the axis or right of it and the rest are told apart exactly") {
  // x1' = x2, x2' = reading of all others, and an integrator of the input that drives the core; in
  // between an oscillator of 3 rad/s, a pole at +0.5, poles -1 +- 20j and -4, in random
  // coordinates.
  Rng rng(8);
  const Index n = 9;
  MatrixXd core = MatrixXd::Zero(6, 6);
  core.block<2, 2>(0, 0) << 0, 3, -3, 0;
  core(2, 2) = 0.5;
  core.block<2, 2>(3, 3) << -1, 20, -20, -1;
  core(5, 5) = -4;
  const MatrixXd turn = rng.matrix(6, 6) + 2 * MatrixXd::Identity(6, 6);
  MatrixXd A = MatrixXd::Zero(n, n);
  A.block<6, 6>(2, 2) = turn * core * turn.inverse();
  A(0, 1) = 1;
  A.block<1, 6>(1, 2) = rng.matrix(1, 6);
  A.block<6, 1>(2, 8) = rng.matrix(6, 1);
  const MatrixXd C = rng.matrix(1, n), B = rng.matrix(n, 1);
  const StateSpace m = model(A, B, C);
  const detail::Split s = detail::split(m);
  CHECK(s.integrals.order() == 3);
  CHECK(s.integrals.A.isUpperTriangular(0));
  CHECK(s.integrals.A.diagonal().isZero(0));
  CHECK(s.kept.order() == 3);
  CHECK(s.stable.order() == 3);
  for (const Complex at : {Complex(0.2, 1), Complex(1, 19), Complex(-2, 0.3), Complex(40, 0)})
    CHECK(relative(sum(s, m, at), m.transfer(at)(0, 0)) <= 1e-11);
  for (const detail::SpectralPart* p : {&s.kept, &s.stable})
    CHECK((p->left * p->right - MatrixXd::Identity(3, 3)).norm() <= 1e-12);
  CHECK(s.stable.A.eigenvalues().real().maxCoeff() <= -0.999);
}

TEST_CASE("two poles at 0 that rounding parts stay together") {
  // 1 / s^2 in coordinates where no entry of A is 0: its eigenvalues come out near +-1e-8.
  Rng rng(4);
  MatrixXd A = MatrixXd::Zero(4, 4);
  A(0, 1) = 1;
  A(2, 2) = -3;
  A(3, 3) = -8;
  const MatrixXd turn = rng.matrix(4, 4) + MatrixXd::Identity(4, 4);
  const StateSpace m = model(turn * A * turn.inverse(), turn * MatrixXd::Ones(4, 1),
                             MatrixXd::Ones(1, 4) * turn.inverse());
  const detail::Split s = detail::split(m);
  CHECK(s.stable.order() == 2);
  for (const Complex at : {Complex(0, 1), Complex(0.1, 9)})
    CHECK(relative(sum(s, m, at),
                   1.0 / (at * at) + 2.0 / at + 1.0 / (at + 3.0) + 1.0 / (at + 8.0)) <= 1e-9);
}

TEST_CASE("truncation costs at most twice the sum of the dropped singular values, everywhere") {
  Rng rng(12);
  const Index n = 10;
  const MatrixXd C = rng.matrix(3, n), B = rng.matrix(n, 2), A = random_stable(rng, n);
  const StateSpace m = model(A, B, C);
  const detail::Split s = detail::split(m);
  const detail::Balancing b = detail::balance(s, {VectorXd::Ones(2), VectorXd::Ones(3)});
  REQUIRE(b.sigma.size() == n);
  for (Index r = 0; r < n; ++r)
    for (const bool truncated : {true, false}) {
      const detail::Cut c = detail::cut(b, r, truncated);
      double worst = 0;
      const auto error = [&](Complex at) {
        const MatrixXcd S = at * MatrixXcd::Identity(r, r) - c.part.A.cast<Complex>();
        MatrixXcd H = c.D.cast<Complex>();
        if (r > 0) H += c.part.C * S.partialPivLu().solve(c.part.B.cast<Complex>());
        return Eigen::JacobiSVD<MatrixXcd>(m.transfer(at) - H).singularValues()(0);
      };
      for (int k = 0; k <= 400; ++k) {
        const double w = std::pow(10, -3 + 6.0 * k / 400);
        worst = std::max({worst, error({0, w}), error({0.3 * w, w}), error({w, 0})});
      }
      CHECK(worst <= detail::cut_bound(b, r) * (1 + 1e-9));
      CHECK(worst >= 0.9 * b.sigma(r));  // no model of this order does better on the axis
      if (r > 0) CHECK(c.part.A.eigenvalues().real().maxCoeff() < 0);
      const Complex exact = truncated ? Complex(1e12, 0) : Complex(0, 0);
      CHECK(error(exact) <= 1e-9 * b.sigma(0));
    }
}
