#include <doctest/doctest.h>

#include <cmath>

#include "sparse_system.hpp"

/// Solves with the transposed factors against dense LU of the transposed matrix.

using namespace solve_test;
using titop::solve::Factors;
using titop_test::Rng;

namespace {

/// Rows and columns times powers of two, 2^-20 to 2^20.
void scale(System& s, Rng& rng) {
  MatrixXd A = s.to_dense();
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    A.row(i) *= std::ldexp(1, rng.below(41) - 20);
    A.col(i) *= std::ldexp(1, rng.below(41) - 20);
  }
  s.from_dense(A);
}

/// |A'x - b| over |A'| |x| + |b|, the largest of all entries.
double backward(const MatrixXd& A, const MatrixXd& x, const MatrixXd& b) {
  const MatrixXd terms = A.cwiseAbs().transpose() * x.cwiseAbs() + b.cwiseAbs();
  return ((A.transpose() * x - b).cwiseAbs().array() / terms.array()).maxCoeff();
}

}  // namespace

TEST_CASE("transposed: solutions as by dense LU on trees, rings, stars, grids and full systems") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Rng rng(seed);
    for (const Kind& kind : kinds(rng)) {
      System s = random_system(kind.links, kind.n, rng, seed % 3 == 0 ? 0 : 2);
      if (seed % 2 == 0) scale(s, rng);
      const MatrixXd A = s.to_dense(), b = rng.matrix(A.rows(), 1 + rng.below(3));
      CAPTURE(seed);
      CAPTURE(kind.name);
      const Factors<double> factors = factors_of(s.structure, s.entries);
      REQUIRE(!factors.health().singular);
      const MatrixXd x = solve_transposed<double>(factors, b);
      if (seed % 2 == 0) {
        CHECK((A.transpose() * x - b).cwiseAbs().maxCoeff() <=
              1e-12 * (A.cwiseAbs().transpose() * x.cwiseAbs() + b.cwiseAbs()).maxCoeff());
        continue;
      }
      CHECK(backward(A, x, b) <= 1e-11);  // of each entry by itself
      const MatrixXd exact = A.transpose().fullPivLu().solve(b);
      const Eigen::JacobiSVD<MatrixXd> svd(A);
      CHECK((x - exact).norm() <=
            1e-14 * svd.singularValues()(0) / svd.singularValues().tail(1)(0) * exact.norm());
    }
  }
}
