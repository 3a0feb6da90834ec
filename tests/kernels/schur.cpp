#include <doctest/doctest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/schur.hpp>
#include <vector>

#include "support/rng.hpp"

/// The algorithms on Schur forms that Eigen does not have: exchange of eigenvalues, Sylvester
/// equations, factors of Gramians. Random, badly scaled, permuted and defective input of orders 0
/// to 12; bounds are those of a backward stable algorithm.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using titop_test::Rng;
using Complex = std::complex<double>;

namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon();

MatrixXcd random_complex(Rng& rng, Index rows, Index cols) {
  MatrixXcd m(rows, cols);
  m.real() = rng.matrix(rows, cols), m.imag() = rng.matrix(rows, cols);
  return m;
}

MatrixXcd random_triangle(Rng& rng, Index n) {
  return random_complex(rng, n, n).triangularView<Eigen::Upper>();
}

enum class InputKind { dense, scaled, permuted, defective, zero };
constexpr InputKind kInputKinds[] = {InputKind::dense, InputKind::scaled, InputKind::permuted,
                                     InputKind::defective, InputKind::zero};

MatrixXd random_square(Rng& rng, InputKind kind, Index n) {
  MatrixXd A = rng.matrix(n, n);
  if (kind == InputKind::zero) A.setZero();
  if (kind == InputKind::defective) {  // one Jordan block, turned
    const MatrixXd Q = MatrixXd(rng.matrix(n, n)).householderQr().householderQ();
    MatrixXd J = 0.5 * MatrixXd::Identity(n, n);
    if (n > 1) J.diagonal(1).setOnes();
    A = Q * J * Q.transpose();
  }
  if (kind == InputKind::permuted) {  // few entries, in odd places
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        if ((3 * i + 5 * j) % 4 != 1) A(i, j) = 0;
  }
  if (kind == InputKind::scaled)
    for (Index i = 0; i < n; ++i) A.row(i) *= std::pow(10.0, rng.between(-6, 6));
  return A;
}

}  // namespace

TEST_CASE("Schur form and exchange of eigenvalues: backward stable at orders 0 to 12") {
  Rng rng(31);
  for (const InputKind kind : kInputKinds)
    for (Index n = 0; n <= 12; ++n) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(n);
      const MatrixXd A = random_square(rng, kind, n);
      linalg::Schur s = linalg::schur(A);
      const auto factors = [&] {
        const double limit = 100 * static_cast<double>(n) * kUnit;
        CHECK((s.Q * s.T * s.Q.adjoint() - A.cast<Complex>()).norm() <= limit * A.norm());
        CHECK((s.Q.adjoint() * s.Q - MatrixXcd::Identity(n, n)).norm() <= limit);
        for (Index j = 0; j < n; ++j)
          for (Index i = j + 1; i < n; ++i) CHECK(s.T(i, j) == Complex(0));
      };
      factors();
      std::vector<char> first;
      Complex marked = 0;
      for (Index i = 0; i < n; ++i) {
        first.push_back(static_cast<char>(rng.below(2)));
        if (first.back()) marked += s.T(i, i);
      }
      const Index count = std::count(first.begin(), first.end(), 1);
      linalg::reorder(s, first);
      factors();
      // The sum of the marked eigenvalues is insensitive where single ones are not.
      const double off = std::abs(s.T.diagonal().head(count).sum() - marked);
      CHECK(off <= 100 * static_cast<double>(n) * kUnit * A.norm());
    }
}

TEST_CASE("parts coupled in one direction: eigenvalues without rounding of the couplings") {
  Rng rng(35);
  for (Index n = 0; n <= 12; ++n)
    for (int trial = 0; trial < 20; ++trial) {
      CAPTURE(n);
      // A triangle in any order of its rows: eigenvalues and couplings of any size.
      MatrixXd A = MatrixXd::Zero(n, n);
      std::vector<Index> order(static_cast<std::size_t>(n));
      for (Index i = 0; i < n; ++i) {
        order[static_cast<std::size_t>(i)] = i;
        A(i, i) = -std::pow(10.0, rng.between(-12, 3));
        for (Index j = 0; j < i; ++j)
          if (rng.chance(0.7)) A(i, j) = std::pow(10.0, rng.between(-3, 12));
      }
      for (Index i = 1; i < n; ++i)
        std::swap(order[static_cast<std::size_t>(i)],
                  order[static_cast<std::size_t>(rng.below(static_cast<int>(i) + 1))]);
      const MatrixXd mixed = A(order, order);
      VectorXd expected = A.diagonal();
      std::sort(expected.begin(), expected.end());
      const auto check = [&](const VectorXcd& values) {
        VectorXd found = values.real();
        std::sort(found.begin(), found.end());
        // The iteration scales by the largest entry, which rounds once each way.
        CHECK(((found - expected).array().abs() <= 4 * kUnit * expected.array().abs()).all());
        CHECK(values.imag().isZero(0));
      };
      check(linalg::schur(mixed).T.diagonal());
      check(linalg::eigensystem(mixed).values);
    }
}

TEST_CASE("Sylvester equations: residuals at rounding level at orders 0 to 12, rows scaled") {
  Rng rng(32);
  for (Index m = 0; m <= 12; ++m)
    for (Index n = 0; n <= 12; ++n)
      for (const double decades : {0.0, 6.0}) {
        CAPTURE(m);
        CAPTURE(n);
        MatrixXcd A = random_triangle(rng, m), B = random_triangle(rng, n);
        for (Index i = 0; i < m; ++i) A.row(i) *= std::pow(10.0, rng.between(-decades, decades));
        const MatrixXcd C = random_complex(rng, m, n);
        const MatrixXcd X = linalg::sylvester(A, B, C);
        REQUIRE(X.rows() == m);
        REQUIRE(X.cols() == n);
        const MatrixXd terms =
            A.cwiseAbs() * X.cwiseAbs() + X.cwiseAbs() * B.cwiseAbs() + C.cwiseAbs();
        const MatrixXd off = (A * X - X * B - C).cwiseAbs();
        CHECK((off.array() <= 8 * static_cast<double>(m + n + 2) * kUnit * terms.array()).all());
      }
}

namespace {

/// T P + P T^H + B B^H = 0, from the last entry to the first, in 50 digits.
MatrixXcd gramian_of_triangle(const MatrixXcd& T, const MatrixXcd& B) {
  using Real = boost::multiprecision::cpp_bin_float_50;
  struct Number {
    Real re = 0, im = 0;
  };
  const auto number = [](Complex c) { return Number{Real(c.real()), Real(c.imag())}; };
  const auto add_product = [](Number& to, const Number& a, const Number& b) {  // a conj(b)
    to.re += a.re * b.re + a.im * b.im, to.im += a.im * b.re - a.re * b.im;
  };
  const Index n = T.rows();
  std::vector<std::vector<Number>> P(static_cast<std::size_t>(n),
                                     std::vector<Number>(static_cast<std::size_t>(n)));
  const auto p = [&](Index i, Index j) -> Number& {
    return P[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  };
  MatrixXcd result(n, n);
  for (Index i = n - 1; i >= 0; --i)
    for (Index j = n - 1; j >= 0; --j) {
      Number sum;
      for (Index k = 0; k < B.cols(); ++k) add_product(sum, number(B(i, k)), number(B(j, k)));
      for (Index k = i + 1; k < n; ++k)
        add_product(sum, number(T(i, k)), {p(k, j).re, -p(k, j).im});
      for (Index k = j + 1; k < n; ++k) add_product(sum, p(i, k), number(T(j, k)));
      const Number t = number(T(i, i) + std::conj(T(j, j)));
      const Real size = t.re * t.re + t.im * t.im;
      p(i, j) = {-(sum.re * t.re + sum.im * t.im) / size, -(sum.im * t.re - sum.re * t.im) / size};
      result(i, j) = {static_cast<double>(p(i, j).re), static_cast<double>(p(i, j).im)};
    }
  return result;
}

}  // namespace

TEST_CASE(
    "factors of Gramians: orders 0 to 12, few inputs, inputs of other sizes, against 50 digits") {
  Rng rng(33);
  for (Index n = 0; n <= 12; ++n)
    for (const Index inputs : {0, 1, 3})
      for (const double decades : {0.0, 5.0}) {
        CAPTURE(n);
        CAPTURE(inputs);
        MatrixXcd T = random_triangle(rng, n), B = random_complex(rng, n, inputs);
        for (Index i = 0; i < n; ++i) {
          T(i, i).real(-rng.between(0.5, 2));
          B.row(i) *= std::pow(10.0, rng.between(-decades, decades));
        }
        const MatrixXcd U = linalg::lyapunov_factor(T, B);
        REQUIRE(U.rows() == n);
        REQUIRE(U.cols() == n);
        const MatrixXcd exact = gramian_of_triangle(T, B);
        const double size = n ? exact.cwiseAbs().maxCoeff() : 0;
        CHECK((U * U.adjoint() - exact).norm() <= 1e-12 * size);
        for (Index j = 0; j < n; ++j)
          for (Index i = j + 1; i < n; ++i) CHECK(U(i, j) == Complex(0));
      }
}
