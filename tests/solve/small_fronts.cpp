#include <doctest/doctest.h>

#include <complex>

#include "solve/exact_numbers.hpp"
#include "sparse_system.hpp"
#include "support/random_matrix.hpp"

/// The elimination in every scalar type, 0 to 12 unknowns in one front and in as many, of the
/// matrix and of its transpose: residuals in 100 digits against the bound of Gaussian elimination
/// with row pivoting, 3 n^3 growth eps of the terms of each row [Higham 2002, theorem 9.5].
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using solve_test::Exact;
using solve_test::exact;
using titop::solve::Factors;
using titop::solve::Scalar;
using titop::solve::Structure;
using titop_test::Input;
using titop_test::Rng;
template <class T>
using Dense = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

/// One group of n scalars, or n of one.
template <class T>
Factors<T> factors_of(const Dense<T>& A, bool one) {
  Structure structure;
  std::vector<solve_test::RowEntries<T>> entries;
  const auto n = static_cast<int>(A.rows());
  if (n > 0 && one) {
    structure.add_variable(n);
    structure.add_row(n, std::vector{0});
    entries.push_back({A});
  } else {
    std::vector<int> all;
    for (int i = 0; i < n; ++i) structure.add_variable(1), all.push_back(i);
    for (int i = 0; i < n; ++i) {
      structure.add_row(1, all);
      entries.emplace_back();
      for (int j = 0; j < n; ++j) entries.back().push_back(A.block(i, j, 1, 1));
    }
  }
  return solve_test::factors_of<T>(structure, entries);
}

/// |b - A x| of a row over eps times its terms: the largest.
template <class T>
double residual(const Dense<T>& A, const Dense<T>& x, const Dense<T>& b) {
  double worst = 0;
  for (Index j = 0; j < b.cols(); ++j)
    for (Index i = 0; i < A.rows(); ++i) {
      Exact off = exact(b(i, j));
      double terms = titop::solve::size_of(b(i, j));
      for (Index k = 0; k < A.cols(); ++k) {
        off -= exact(A(i, k)) * exact(x(k, j));
        terms += titop::solve::size_of(A(i, k)) * titop::solve::size_of(x(k, j));
      }
      const double left =
          static_cast<double>(abs(off.real())) + static_cast<double>(abs(off.imag()));
      worst = std::max(worst, left / (Scalar<T>::epsilon() * terms));
    }
  return worst;
}

template <class T>
Dense<T> random_numbers(Rng& rng, Input input, Index n) {
  Dense<T> A = titop::solve::lifted<T>(titop_test::random_matrix(rng, input, n));
  if constexpr (!std::is_same_v<T, double>)
    if (input != Input::singular)
      for (T& a : A.reshaped()) a *= Scalar<T>::from(std::polar(1.0, rng.between(-1, 1)));
  return A;
}

}  // namespace

TEST_CASE_TEMPLATE("fronts of 0 to 12 unknowns: dense, scaled, permuted and singular matrices", T,
                   double, std::complex<double>, std::complex<long double>,
                   std::complex<titop::solve::DoubleDouble>, titop::solve::Complex50) {
  constexpr double kGrowth = 8;
  Rng rng(12);
  for (Index n = 0; n <= 12; ++n)
    for (const Input input : titop_test::kInputs)
      for (const bool one : {true, false}) {
        CAPTURE(n);
        CAPTURE(static_cast<int>(input));
        CAPTURE(one);
        const Dense<T> A = random_numbers<T>(rng, input, n),
                       b = titop::solve::lifted<T>(rng.matrix(n, 2));
        const Factors<T> factors = factors_of<T>(A, one);
        if (input == Input::singular && n > 0) {  // rounding may leave a weak pivot
          const titop::solve::Health health = factors.health();
          CHECK((health.singular || health.weakest <= 500 * Scalar<T>::epsilon()));
          continue;
        }
        REQUIRE(!factors.health().singular);
        const Dense<T> x = solve_test::solve<T>(factors, b);
        CHECK(residual<T>(A, x, b) <= 3 * static_cast<double>(n * n * n) * kGrowth);
        const Dense<T> y = solve_test::solve_transposed<T>(factors, b);
        CHECK(residual<T>(A.transpose(), y, b) <= 3 * static_cast<double>(n * n * n) * kGrowth);
      }
}
