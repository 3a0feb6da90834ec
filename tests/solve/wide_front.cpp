#include <doctest/doctest.h>

#include "sparse_system.hpp"
#include "support/rng.hpp"

/// Dense matrices in one front, as separators of large grids are. Bounds of entries add up as
/// |L| |U| does, which grows slowly with the width for random numbers, not as a product over rows.

namespace {

using solve_test::MatrixXd;
using titop_test::Rng;

MatrixXd random_matrix(int n, Rng& rng) {
  MatrixXd a(n, n);
  for (double& x : a.reshaped()) x = rng.between(-1, 1);
  return a;
}

titop::solve::Factors<double> factors_of(const MatrixXd& a) {
  titop::solve::Structure structure;
  structure.add_variable(static_cast<int>(a.rows()));
  structure.add_row(static_cast<int>(a.rows()), std::vector{0});
  return solve_test::factors_of<double>(structure, {{a}});
}

}  // namespace

TEST_CASE("wide fronts of regular matrices keep their digits, and solve to them") {
  Rng rng(5);
  for (const int n : {1, 10, 40, 120, 250}) {
    CAPTURE(n);
    const MatrixXd a = random_matrix(n, rng), x = MatrixXd::Ones(n, 1);
    const auto factors = factors_of(a);
    REQUIRE_FALSE(factors.health().singular);
    CHECK(factors.health().weakest > 1e-8);
    // Condition numbers of random matrices: some n, hardly ever above 100 n.
    CHECK((solve_test::solve<double>(factors, a * x) - x).cwiseAbs().maxCoeff() <
          1e-15 * 100 * n * n);
  }
}

TEST_CASE("a wide front with dependent rows is singular") {
  Rng rng(6);
  for (const int n : {2, 10, 40, 120, 250}) {
    CAPTURE(n);
    MatrixXd a = random_matrix(n, rng);
    a.row(n / 2) = a.row(0);
    if (n > 2) a.row(n / 2) -= 0.5 * a.row(n - 1);
    CHECK(factors_of(a).health().singular);
  }
}
