#include <doctest/doctest.h>

#include <titop/compiler/solve/response.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/titop.hpp>

#include "support/structured_lti.hpp"

/// States that no path of nonzero entries reaches are 0 to the last bit, in every precision, and by
/// Schur forms too; sparse A in far units keeps its digits.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using titop::detail::Resolvent;
using titop::solve::Dense;

namespace {

/// 1 where (|A| + 1)^n |B|, of zeros and ones, is not 0.
MatrixXd reached(const MatrixXd& A, const MatrixXd& B) {
  const auto ones = [](const MatrixXd& m) { return MatrixXd((m.array() != 0).cast<double>()); };
  MatrixXd at = ones(B);
  for (Index k = 0; k < A.rows(); ++k) at = ones(at + ones(A) * at);
  return at;
}

Dynamics dynamics(const Lti& m) { return {m.A, m.B, m.C, MatrixXd::Zero(m.C.rows(), m.B.cols())}; }

/// Numbers other than 0 where nothing arrives.
template <class T>
int noise(const Dense<T>& x, const MatrixXd& there) {
  int count = 0;
  for (Index i = 0; i < x.size(); ++i) count += there(i) == 0 && titop::solve::size_of(x(i)) != 0;
  return count;
}

/// Copies of m side by side, each in its own inputs and outputs.
Lti side_by_side(const Lti& m, Index copies) {
  const Index n = m.A.rows(), nu = m.B.cols(), ny = m.C.rows();
  Lti all{MatrixXd::Zero(copies * n, copies * n),
          MatrixXd::Zero(copies * n, copies * nu),
          MatrixXd::Zero(copies * ny, copies * n),
          {}};
  for (Index k = 0; k < copies; ++k) {
    all.A.block(k * n, k * n, n, n) = m.A;
    all.B.block(k * n, k * nu, n, nu) = m.B;
    all.C.block(k * ny, k * n, ny, n) = m.C;
  }
  return all;
}

}  // namespace

TEST_CASE_TEMPLATE("(s - A)^-1 B is 0 to the last bit where no path leads", T, std::complex<double>,
                   std::complex<long double>, std::complex<titop::solve::DoubleDouble>,
                   titop::solve::Complex50) {
  int zeros = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CAPTURE(seed);
    const Dynamics d = dynamics(titop_test::structured_lti(seed, true).lti);
    const MatrixXd there = reached(d.A, d.B);
    const Resolvent<T> resolvent(d, titop::solve::Scalar<T>::from(std::complex<double>(0.3, 1.1)));
    CHECK(noise<T>(resolvent.times(titop::solve::lifted<T>(d.B)), there) == 0);
    zeros += static_cast<int>((there.array() == 0).count());
  }
  CHECK(zeros >= 20);
}

TEST_CASE("the response of an Lti is 0 to the last bit where no path leads, few states and many") {
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const Index copies : {1, 20}) {
      CAPTURE(seed);
      CAPTURE(copies);
      const Lti m = side_by_side(titop_test::structured_lti(seed, true).lti, copies);
      const Block::Response r = as_block(m)->response({0.3, 1.1}, {});
      CHECK(noise<std::complex<double>>(r.X, reached(m.A, m.B)) == 0);
    }
}

TEST_CASE("(s - A)^-1 B does not depend on the units of the states") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    const Lti one = titop_test::structured_lti(seed, false).lti,
              far = titop_test::structured_lti(seed, true).lti;
    const auto y = [](const Lti& m) {
      const Dynamics d = dynamics(m);
      const Resolvent<std::complex<long double>> resolvent(d, {0.3L, 1.1L});
      return Eigen::MatrixXcd((d.C.cast<std::complex<long double>>() *
                               resolvent.times(d.B.cast<std::complex<long double>>()))
                                  .cast<std::complex<double>>());
    };
    const Eigen::MatrixXcd a = y(one), b = y(far);
    CHECK((a - b).norm() <= 1e-14 * a.norm());
  }
}
