#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>

#include "support/rng.hpp"

// Products of matrices, as the library compiles them, against sums in long double.
namespace {

using Eigen::Index;
using Complex = std::complex<double>;
template <class T>
using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
using Exact = std::complex<long double>;

titop_test::Rng rng(20261128);

template <class T>
T number() {
  if constexpr (std::is_same_v<T, Complex>)
    return {rng.between(-2, 2), rng.between(-2, 2)};
  else
    return rng.between(-2, 2);
}

/// Columns differ in size by up to 1e16, rows by up to 1e8.
template <class T>
Matrix<T> scaled_random(Index rows, Index cols) {
  Matrix<T> m = Matrix<T>::NullaryExpr(rows, cols, [] { return number<T>(); });
  for (Index i = 0; i < rows; ++i) m.row(i) *= std::pow(10, rng.between(-4, 4));
  for (Index j = 0; j < cols; ++j) m.col(j) *= std::pow(10, rng.between(-8, 8));
  return m;
}

Exact exact(double x) { return {x, 0}; }
Exact exact(Complex x) { return {x.real(), x.imag()}; }

/// The largest error of `got` - start - sign left right over the sum of the terms' sizes.
template <class G, class S, class L, class R>
double error(const G& got, const S& start, double sign, const L& left, const R& right) {
  REQUIRE(got.rows() == left.rows());
  REQUIRE(got.cols() == right.cols());
  REQUIRE(got.allFinite());
  long double worst = 0;
  for (Index i = 0; i < got.rows(); ++i)
    for (Index j = 0; j < got.cols(); ++j) {
      Exact sum = exact(start(i, j));
      long double terms = abs(sum);
      for (Index k = 0; k < left.cols(); ++k) {
        const Exact term = exact(left(i, k)) * exact(right(k, j));
        sum += static_cast<long double>(sign) * term;
        terms += abs(term);
      }
      const long double off = abs(exact(got(i, j)) - sum);
      if (off > 0) worst = std::max(worst, off / terms);
    }
  return static_cast<double>(worst);
}

/// Every way to write the product of two expressions into a matrix, a block and a transpose.
template <class T, class L, class R>
double worst_error(const L& left, const R& right) {
  const Matrix<T> a = left, b = right;  // for the sums
  const Index rows = a.rows(), cols = b.cols();
  const Matrix<T> start = scaled_random<T>(rows, cols), zero = Matrix<T>::Zero(rows, cols);
  double worst = 0;
  const auto check = [&](const auto& got, const Matrix<T>& from, double sign) {
    worst = std::max(worst, error(got, from, sign, a, b));
  };
  Matrix<T> c = left * right;
  check(c, zero, 1);
  c = start;
  c.noalias() += left * right;
  check(c, start, 1);
  c = start;
  c -= left * right;
  check(c, start, -1);
  c = start;
  c += 0.5 * left * right;
  check(c, start, 0.5);
  c = (-2.0 * left) * (right * 0.25);
  check(c, zero, -0.5);
  Matrix<T> frame = Matrix<T>::Zero(rows + 3, cols + 2);
  frame.block(1, 2, rows, cols).noalias() = left * right;
  check(frame.block(1, 2, rows, cols), zero, 1);
  frame.block(1, 2, rows, cols).setZero();
  CHECK(frame == Matrix<T>::Zero(rows + 3, cols + 2));
  Matrix<T> turned(cols, rows);
  turned.transpose().noalias() = left * right;
  check(turned.transpose(), zero, 1);
  for (Index j = 0; j < cols; ++j) {
    const Matrix<T> column = left * right.col(j);
    worst = std::max(worst, error(column, Matrix<T>::Zero(rows, 1), 1, a, b.col(j)));
    c = start;
    c.col(j).noalias() -= left * right.col(j);
    worst = std::max(worst, error(c.col(j), start.col(j), -1, a, b.col(j)));
  }
  for (Index i = 0; i < rows; ++i) {
    const Matrix<T> row = left.row(i) * right;
    worst = std::max(worst, error(row, Matrix<T>::Zero(1, cols), 1, a.row(i), b));
    c = start;
    c.row(i).noalias() += left.row(i) * right;
    worst = std::max(worst, error(c.row(i), start.row(i), 1, a.row(i), b));
  }
  return worst;
}

template <class A, class B>
double worst_error_of(Index rows, Index inner, Index cols) {
  using T = titop::linalg::ProductScalar<A, B>;
  const Matrix<A> a = scaled_random<A>(rows, inner), at = scaled_random<A>(inner, rows);
  const Matrix<B> b = scaled_random<B>(inner, cols), bt = scaled_random<B>(cols, inner);
  double worst = worst_error<T>(a, b);
  worst = std::max(worst, worst_error<T>(at.transpose(), b));
  worst = std::max(worst, worst_error<T>(a, bt.transpose()));
  worst = std::max(worst, worst_error<T>(at.adjoint(), bt.adjoint()));
  const Matrix<A> around = scaled_random<A>(rows + 2, inner + 3);
  worst = std::max(worst, worst_error<T>(around.block(1, 1, rows, inner), b));
  return worst;
}

template <class A, class B>
double worst_error_of_all_sizes() {
  double worst = 0;
  for (Index rows = 0; rows <= 12; rows += 3)
    for (Index inner = 0; inner <= 12; inner += 2)
      for (Index cols = 0; cols <= 12; cols += 4)
        worst = std::max(worst, worst_error_of<A, B>(rows, inner, cols));
  for (const Index size : {1, 5, 33}) worst = std::max(worst, worst_error_of<A, B>(40, size, 30));
  return worst;
}

TEST_CASE("products of real and complex expressions round each term once") {
  // 40 terms at most, and a product of complex numbers rounds three times.
  const double bound = 50 * std::numeric_limits<double>::epsilon();
  CHECK(worst_error_of_all_sizes<double, double>() <= bound);
  CHECK(worst_error_of_all_sizes<double, Complex>() <= bound);
  CHECK(worst_error_of_all_sizes<Complex, double>() <= bound);
  CHECK(worst_error_of_all_sizes<Complex, Complex>() <= bound);
}

TEST_CASE("a product reads its operands before the result is written over them") {
  const Matrix<double> a = scaled_random<double>(9, 9), b = scaled_random<double>(9, 9);
  Matrix<double> c = a;
  c = b * c;
  CHECK(error(c, Matrix<double>::Zero(9, 9), 1, b, a) <= 1e-14);
  c = a;
  c.col(2) = c * c.col(2);
  CHECK(error(c.col(2), Matrix<double>::Zero(9, 1), 1, a, a.col(2)) <= 1e-14);
}

TEST_CASE("operands that do not lie in memory are evaluated") {
  const Matrix<double> a = scaled_random<double>(9, 7), b = scaled_random<double>(9, 7),
                       x = scaled_random<double>(7, 8);
  const Matrix<double> sum = a + b, sizes = a.cwiseAbs();
  const Matrix<double> of_sum = (a + b) * x, of_sizes = a.cwiseAbs() * x;
  const Eigen::VectorXd of_column = (a + b) * (2 * x.col(1) - x.col(2));
  CHECK(error(of_sum, Matrix<double>::Zero(9, 8), 1, sum, x) <= 1e-14);
  CHECK(error(of_sizes, Matrix<double>::Zero(9, 8), 1, sizes, x) <= 1e-14);
  const Eigen::VectorXd column = 2 * x.col(1) - x.col(2);
  CHECK(error(of_column, Matrix<double>::Zero(9, 1), 1, sum, column) <= 1e-14);
  const Matrix<Complex> z = scaled_random<Complex>(9, 7);
  const Eigen::VectorXd of_real = z.real() * x.col(0);
  CHECK(error(of_real, Matrix<double>::Zero(9, 1), 1, Matrix<double>(z.real()), x.col(0)) <= 1e-14);
  const Matrix<double> row_of_real = z.real().row(3) * x;
  CHECK(error(row_of_real, Matrix<double>::Zero(1, 8), 1, Matrix<double>(z.real()).row(3), x) <=
        1e-14);
}

}  // namespace
