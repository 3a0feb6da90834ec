#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <boost/multiprecision/cpp_complex.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <numeric>
#include <titop/graph/linalg/shifted.hpp>
#include <titop/titop.hpp>

#include "support/rng.hpp"

// (s - A)^-1 B by one Schur form, against solutions in 50 digits.
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;
using Complex50 = boost::multiprecision::cpp_complex_50;
using Matrix50 = Eigen::Matrix<Complex50, Eigen::Dynamic, Eigen::Dynamic>;
using titop::linalg::ShiftedSolver;

titop_test::Rng rng(46);

/// Entries of either sign with the variance 1.
MatrixXd random(Index rows, Index cols) { return std::sqrt(3.0) * rng.matrix(rows, cols); }

/// States in units that differ by up to 1e12, in random order.
void change_units(MatrixXd& A, MatrixXd& B) {
  const Eigen::VectorXd unit =
      Eigen::VectorXd::NullaryExpr(A.rows(), [&] { return std::pow(10, rng.between(-6, 6)); });
  A = (unit.asDiagonal() * A * unit.cwiseInverse().asDiagonal()).eval();
  B = (unit.asDiagonal() * B).eval();
  std::vector<Index> order(static_cast<std::size_t>(A.rows()));
  std::iota(order.begin(), order.end(), 0);
  rng.shuffle(order);
  A = A(order, order).eval();
  B = B(order, Eigen::all).eval();
}

MatrixXcd in_50_digits(const MatrixXd& A, const MatrixXd& B, Complex s) {
  Matrix50 K = -A.cast<Complex50>();
  for (Index i = 0; i < A.rows(); ++i) K(i, i) += Complex50(s.real(), s.imag());
  const Matrix50 X = K.partialPivLu().solve(Matrix50(B.cast<Complex50>()));
  return X.unaryExpr([](const Complex50& x) {
    return Complex(static_cast<double>(x.real()), static_cast<double>(x.imag()));
  });
}

/// Largest error of an entry over what rounding of the entries of s - A and B by one unit makes of
/// it: |K^-1| (|K| |X| + |B|).
double worst(const MatrixXcd& got, const MatrixXd& A, const MatrixXd& B, Complex s) {
  const MatrixXcd right = in_50_digits(A, B, s);
  const Index n = A.rows();
  const MatrixXd sizes = A.cwiseAbs() + std::abs(s) * MatrixXd::Identity(n, n);
  const MatrixXcd inverse = in_50_digits(A, MatrixXd::Identity(n, n), s);
  const MatrixXd allowed = inverse.cwiseAbs() * (sizes * right.cwiseAbs() + B.cwiseAbs());
  double result = 0;
  for (Index i = 0; i < got.size(); ++i)
    if (allowed(i) > 0) result = std::max(result, std::abs(got(i) - right(i)) / allowed(i));
  return result / std::numeric_limits<double>::epsilon();
}

}  // namespace

TEST_CASE("(s - A)^-1 B by a Schur form: random, scaled, permuted systems of 0 to 40 states") {
  double largest = 0;
  for (const Index n : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 40})
    for (int kind = 0; kind < 3; ++kind) {
      MatrixXd A = random(n, n) - 2 * MatrixXd::Identity(n, n), B = random(n, 2);
      if (kind > 0) change_units(A, B);
      if (kind > 1 && n > 1) A.row(0) = A.row(n - 1);  // a pole at 0
      const ShiftedSolver solver(A, B);
      for (const Complex s :
           {Complex(0, 1e-6), Complex(0, 0.3), Complex(0, 40), Complex(0.2, 1e7)}) {
        const MatrixXcd X = solver.solve(s).z;
        REQUIRE(X.rows() == n);
        REQUIRE(X.allFinite());
        largest = std::max(largest, worst(X, A, B, s));
      }
    }
  CHECK(largest <= 40);  // about the number of states, in units of the last place
}

TEST_CASE("(s - A)^-1 B of parts that do not act on each other, in any order of their states") {
  double largest = 0;
  for (int kind = 0; kind < 3; ++kind) {
    const Index n = 30;
    MatrixXd A = MatrixXd::Zero(n, n), B = random(n, 2);
    for (Index i = 0; i < 24; i += 2) {
      const double w = std::pow(10.0, double(i) / 4 - 2);
      A.block(i, i, 2, 2) << 0, w, -w, -0.01 * w;
    }
    A.block(24, 24, 4, 4) = random(4, 4);
    A(28, 28) = -0.3;  // and a pole at 0
    if (kind > 0) change_units(A, B);
    // Sets of states with a path of entries between them, by Warshall's closure.
    Eigen::MatrixXi joined = (A.array() != 0 || A.transpose().array() != 0).cast<int>();
    joined.diagonal().setOnes();
    for (Index k = 0; k < n; ++k) joined = joined.cwiseMax(joined.col(k) * joined.row(k));
    const auto parts = titop::linalg::uncoupled_parts(A);
    CHECK(parts.size() == 12 + 1 + 2);
    Index states = 0;
    for (const std::vector<int>& part : parts) {
      states += std::ssize(part);
      CHECK(joined(part, part).minCoeff() == 1);
    }
    CHECK(states == n);
    CHECK(joined.sum() == 12 * 4 + 16 + 2);
    const ShiftedSolver solver(A, B);
    for (const Complex s : {Complex(0, 1e-3), Complex(0, 0.3), Complex(0, 40), Complex(0.2, 1e7)})
      largest = std::max(largest, worst(solver.solve(s).z, A, B, s));
    CHECK(solver.solve(0).rcond <= 1e-14);
  }
  CHECK(largest <= 40);
}

TEST_CASE("(s - A)^-1 B at a pole, and beside one") {
  MatrixXd A = random(12, 12), B = random(12, 1);
  A.row(3).setZero();  // a pole that is 0
  const ShiftedSolver solver(A, B);
  CHECK(solver.solve(0).rcond <= 1e-14);
  CHECK(titop::linalg::refined_response(A, B, MatrixXd::Identity(12, 12), MatrixXd::Zero(12, 1), 0)
            .rcond <= 1e-14);
  for (const double beside : {1e-3, 1e-6, 1e-9, 1e-12})
    CHECK(worst(solver.solve(beside).z, A, B, beside) <= 40);
}

TEST_CASE("an Lti of many states has the transfer of its matrices") {
  MatrixXd A = random(60, 60) / 8 - 1.5 * MatrixXd::Identity(60, 60), B = random(60, 2);
  change_units(A, B);
  const MatrixXd C = random(2, 60);
  titop::Diagram d{"many"};
  auto u = d.input("u", 2);
  auto k = d.add("k", titop::Lti{.A = A, .B = B, .C = C});
  k.in = u;
  d.output("y", 2) = k.out;
  const titop::System system = titop::compile(d, {.minimize_up_to = 0});
  for (const Complex s : {Complex(0, 1e-3), Complex(0, 0.7), Complex(0, 30)}) {
    const MatrixXcd right = C * in_50_digits(A, B, s);
    const MatrixXcd got = system.transfer(s);
    CHECK((got - right).cwiseAbs().maxCoeff() <= 1e-11 * right.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("C (s - A)^-1 B + D in residuals of 64 bits: a thousandth of the data's own error") {
  double largest = 0;
  for (const Index n : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 40})
    for (int kind = 0; kind < 4; ++kind) {
      MatrixXd A = random(n, n) - 2 * MatrixXd::Identity(n, n), B = random(n, 2);
      if (kind == 3) {  // integrators in a row: no digit in a condition number
        A.setZero();
        if (n > 1) A.diagonal(-1).setConstant(20);
      }
      if (kind > 0) change_units(A, B);
      if (kind == 2 && n > 1) A.row(0) = A.row(n - 1);
      const MatrixXd C = random(3, n), D = random(3, 2);
      for (const Complex s : {Complex(0, 1e-2), Complex(0, 0.3), Complex(0.2, 40)}) {
        const MatrixXcd X = in_50_digits(A, B, s), right = C * X + D.cast<Complex>(),
                        got = titop::linalg::refined_response(A, B, C, D, s).z;
        const MatrixXd sizes = A.cwiseAbs() + std::abs(s) * MatrixXd::Identity(n, n);
        const MatrixXd left = in_50_digits(A.transpose(), C.transpose(), s).transpose().cwiseAbs();
        const MatrixXd of_data = left * (sizes * X.cwiseAbs() + B.cwiseAbs()) +
                                 C.cwiseAbs() * X.cwiseAbs() + D.cwiseAbs();
        REQUIRE(got.rows() == 3);
        REQUIRE(got.allFinite());
        // `right` has the rounding of C X in double: the terms of that sum, not of the solution.
        const MatrixXd allowed = 1e-3 * of_data + C.cwiseAbs() * X.cwiseAbs() + D.cwiseAbs();
        largest =
            std::max(largest, ((got - right).cwiseAbs().array() / allowed.array()).maxCoeff() /
                                  std::numeric_limits<double>::epsilon());
      }
    }
  CHECK(largest <= 4);
}
