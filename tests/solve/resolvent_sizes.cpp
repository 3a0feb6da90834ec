#include <doctest/doctest.h>

#include <titop/compiler/solve/response.hpp>
#include <titop/compiler/solve/scalar.hpp>

#include "generate/diagrams/lti.hpp"
#include "solve/exact_numbers.hpp"
#include "support/rng.hpp"

/// (s - A)^-1 in every scalar type, 0 to 12 states: the residual (s - A) x - r in 100 digits
/// against the bound of Gaussian elimination with row pivoting, |residual| <= 3 n^3 growth eps
/// max(|s - A| |x|) [Higham 2002, theorem 9.5], in any units of the states (columns).
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using solve_test::Exact;
using solve_test::exact;
using titop::detail::Resolvent;
using titop::generate::LtiKind;
using titop::solve::Dense;
using titop::solve::lift;
using titop::solve::Scalar;
using titop_test::Rng;
/// Over the bound's right side without its constant.
template <class T>
double residual_over_bound(const MatrixXd& A, const T& s, const Dense<T>& x, const Dense<T>& r) {
  double left = 0, most = 0;
  for (Index j = 0; j < r.cols(); ++j)
    for (Index i = 0; i < A.rows(); ++i) {
      Exact sum = exact(s) * exact(x(i, j)) - exact(r(i, j));
      double terms =
          (titop::solve::size_of(s) + std::abs(A(i, i))) * titop::solve::size_of(x(i, j));
      for (Index k = 0; k < A.rows(); ++k) {
        sum -= Exact(A(i, k)) * exact(x(k, j));
        if (k != i) terms += std::abs(A(i, k)) * titop::solve::size_of(x(k, j));
      }
      const double off =
          static_cast<double>(abs(sum.real())) + static_cast<double>(abs(sum.imag()));
      if (!std::isfinite(off)) return HUGE_VAL;
      left = std::max(left, off), most = std::max(most, terms);
    }
  return left == 0 ? 0 : left / (Scalar<T>::epsilon() * most);
}

titop::Dynamics dynamics(const titop::Lti& spec) {
  return {spec.A, spec.B, spec.C, MatrixXd::Zero(spec.C.rows(), spec.B.cols())};
}

template <class T>
void check_sizes(const T& s) {
  constexpr double kGrowth =
      8;  // of random matrices it is about n^(2/3) [Trefethen, Schreiber 1990]
  Rng rng(4601);
  for (Index n = 0; n <= 12; ++n)
    for (const LtiKind kind : titop::generate::kLtiKinds) {
      CAPTURE(n);
      CAPTURE(static_cast<int>(kind));
      const titop::Dynamics d = dynamics(titop::generate::random_lti(rng, kind, n, 3, 1));
      const Resolvent<T> resolvent(d, s);
      CHECK(!resolvent.singular());
      const Dense<T> r = titop::solve::lifted<T>(d.B);
      const double cube = static_cast<double>(n * n * n);
      CHECK(residual_over_bound<T>(d.A, s, resolvent.times(r), r) <= 3 * cube * kGrowth);
      Dense<T> in_place = r.leftCols(1);
      resolvent.apply(1, in_place.data());
      CHECK(residual_over_bound<T>(d.A, s, in_place, r.leftCols(1)) <= 3 * cube * kGrowth);
    }
}

/// Poles that integers hit exactly: a pivot is 0 in any order of rows.
template <class T>
void check_singular() {
  Rng rng(4602);
  for (Index n = 1; n <= 12; ++n) {
    CAPTURE(n);
    // s - A has a column of zeros, behind others that have swapped rows.
    titop::Dynamics d = dynamics(titop::generate::random_lti(rng, LtiKind::permuted, n, 1, 1));
    const Index zero = rng.below(static_cast<int>(n));
    d.A.col(zero).setZero();
    d.A(zero, zero) = 2;
    const Resolvent<T> resolvent(d, lift<T>(2.0));
    CHECK(resolvent.singular());
    const Dense<T> x = resolvent.times(titop::solve::lifted<T>(d.B));
    bool finite = true;
    for (const T& entry : x.reshaped())
      finite = finite && std::isfinite(titop::solve::size_of(entry));
    CHECK(!finite);
  }
}

}  // namespace

TEST_CASE_TEMPLATE("(s - A)^-1 of 0 to 12 states is right to rounding", T, std::complex<double>,
                   std::complex<long double>, std::complex<titop::solve::DoubleDouble>,
                   titop::solve::Complex50) {
  for (const std::complex<double> s : {std::complex<double>(1, 0), {0, 1e-3}, {0.3, 7}})
    check_sizes<T>(Scalar<T>::from(s));
  check_singular<T>();
}

TEST_CASE("(s - A)^-1 of 0 to 12 states at a real s is right to rounding") {
  for (const double s : {1.0, 1e-3, -7.0}) check_sizes<double>(s);
  check_singular<double>();
}
