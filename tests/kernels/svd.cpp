#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <titop/graph/linalg/svd.hpp>
#include <vector>

#include "support/rng.hpp"

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// Of parts that nothing couples, in an order of the rows and columns drawn at random; a part in
/// four has rank one.
MatrixXd of_parts(Index rows, Index columns, titop_test::Rng& rng) {
  MatrixXd M = MatrixXd::Zero(rows, columns);
  for (Index i = 0, j = 0; i < rows && j < columns;) {
    const Index m = std::min<Index>(1 + rng.below(5), rows - i),
                n = std::min<Index>(1 + rng.below(5), columns - j);
    const double size = std::pow(10.0, rng.below(7) - 3);
    M.block(i, j, m, n) = rng.below(4) == 0 ? MatrixXd(rng.matrix(m, 1) * rng.matrix(1, n))
                                            : MatrixXd(size * rng.matrix(m, n));
    i += m, j += n;
  }
  std::vector<Index> down(static_cast<std::size_t>(rows)),
      across(static_cast<std::size_t>(columns));
  std::iota(down.begin(), down.end(), Index{0});
  std::iota(across.begin(), across.end(), Index{0});
  rng.shuffle(down);
  rng.shuffle(across);
  return M(down, across);
}

double off_identity(const MatrixXd& U) {
  return (U.transpose() * U - MatrixXd::Identity(U.cols(), U.cols())).cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("singular values of matrices of parts: the product, and orthogonal vectors") {
  titop_test::Rng rng(1);
  for (int k = 0; k < 600; ++k) {
    const Index rows = rng.below(41), columns = k % 3 == 0 ? rng.below(41) : rows;
    CAPTURE(rows);
    CAPTURE(columns);
    const MatrixXd M = of_parts(rows, columns, rng);
    const titop::linalg::Svd s = titop::linalg::svd(M);
    REQUIRE(s.sigma.size() == std::min(rows, columns));
    if (M.size() == 0) continue;
    CHECK(std::is_sorted(s.sigma.begin(), s.sigma.end(), std::greater<>()));
    CHECK((M - s.U * s.sigma.asDiagonal() * s.V.transpose()).norm() <= 1e-12 * M.norm());
    CHECK(off_identity(s.U) <= 1e-12);
    CHECK(off_identity(s.V) <= 1e-12);
  }
}
