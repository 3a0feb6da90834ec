#include <doctest/doctest.h>

#include <cmath>

#include "sparse_system.hpp"

/// Solves with the transposed factors against dense LU of the transposed matrix.

using namespace solve_test;
using titop::solve::Factors;
using titop_test::Rng;

namespace {

/// Right-hand sides by variable, solutions by row.
MatrixXd transposed(const Factors<double>& factors, const MatrixXd& b) {
  const auto& plan = factors.plan();
  RowMatrix<double> g(b.rows(), b.cols());
  Eigen::Index row = 0;
  for (std::size_t v = 0; v < plan.first.size(); ++v) {
    const int size = plan.structure.variable_size[v];
    g.middleRows(plan.first[v], size) = b.middleRows(row, size);
    row += size;
  }
  return factors.solve_transposed(g);
}

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
      const MatrixXd x = transposed(factors, b);
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

TEST_CASE("transposed: full matrices of 0 to 12 rows, permuted") {
  for (int n = 0; n <= 12; ++n) {
    Rng rng(static_cast<std::uint64_t>(n) + 1);
    Structure structure;
    std::vector<int> all;
    for (int v = 0; v < n; ++v) structure.add_variable(1), all.push_back(v);
    std::vector<RowEntries<double>> entries;
    for (int r = 0; r < n; ++r) {
      structure.add_row(1, all);
      RowEntries<double> row;
      for (int v = 0; v < n; ++v)  // the largest entry is far off the diagonal
        row.push_back(rng.matrix(1, 1) +
                      MatrixXd::Constant(1, 1, v == (5 * r + 2) % n ? 3.0 : 0.0));
      entries.push_back(row);
    }
    CAPTURE(n);
    System s{structure, entries};
    const MatrixXd A = s.to_dense(), b = rng.matrix(n, 2);
    const MatrixXd x = transposed(factors_of(structure, entries), b);
    REQUIRE(x.rows() == n);
    if (n > 0) CHECK((A.transpose() * x - b).norm() <= 1e-13 * A.norm() * x.norm());
  }
}
