#include <doctest/doctest.h>

#include "sparse_system.hpp"

/// Verdict and weakest pivot do not depend on units: rows and columns scaled by powers of ten.

using namespace solve_test;
using titop::solve::Health;
using titop_test::Rng;

namespace {

VectorXd powers(Rng& rng, Eigen::Index n) {
  VectorXd d(n);
  for (Eigen::Index i = 0; i < n; ++i) d(i) = std::pow(10.0, rng.below(19) - 9);
  return d;
}

struct Solved {
  Health health;
  MatrixXd x;
};
Solved solved(const System& s, const MatrixXd& b) {
  const auto factors = factors_of(s.structure, s.entries);
  return {factors.health(), solve<double>(factors, b)};
}

}  // namespace

TEST_CASE("solver: scaling rows and columns by 1e-9 to 1e9 changes neither verdict nor digits") {
  double ratio = 1, error = 0, before = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Rng rng(seed);
    for (const Kind& kind : kinds(rng)) {
      const System s = random_system(kind.links, kind.n, rng, 2);
      const MatrixXd A = s.to_dense(), b = rng.matrix(A.rows(), 2);
      const VectorXd rows = powers(rng, A.rows()), cols = powers(rng, A.rows());
      System other = s;
      other.from_dense(rows.asDiagonal() * A * cols.asDiagonal());
      CAPTURE(seed);
      CAPTURE(kind.name);
      const Solved one = solved(s, b), two = solved(other, rows.asDiagonal() * b);
      REQUIRE(one.health.singular == two.health.singular);
      const MatrixXd exact = A.fullPivLu().solve(b);
      const double e1 = (one.x - exact).norm() / exact.norm();
      const double e2 = (cols.asDiagonal() * two.x - exact).norm() / exact.norm();
      before = std::max(before, e1);
      error = std::max(error, e2);
      const double weak = one.health.weakest / two.health.weakest;
      ratio = std::max({ratio, weak, 1 / weak});
      CHECK(weak <= 100);
      CHECK(1 / weak <= 100);
    }
  }
  MESSAGE("largest ratio of the weakest pivots " << ratio << ", errors " << before << " and "
                                                 << error);
  CHECK(error <= 100 * before);
}
