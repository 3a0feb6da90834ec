#include <doctest/doctest.h>

#include <cmath>
#include <titop/graph/linalg/similarity_scaling.hpp>

#include "support/rng.hpp"

/// Scalings by least squares of logarithms: the same result in any units.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using titop_test::Rng;

namespace {

Eigen::VectorXd random_units(Rng& rng, Index n) {
  Eigen::VectorXd units(n);
  for (Index i = 0; i < n; ++i) units(i) = std::pow(10.0, rng.between(-12, 12));
  return units;
}

MatrixXd scaled(const MatrixXd& M) {
  const linalg::TwoSidedScaling by = linalg::two_sided_scaling(M);
  return by.row.asDiagonal() * M * by.column.asDiagonal();
}

}  // namespace

TEST_CASE("two-sided scaling: independent of the units, 1 where units alone differ") {
  Rng rng(36);
  for (Index rows = 0; rows <= 12; ++rows)
    for (Index columns = 0; columns <= 12; columns += 3) {
      CAPTURE(rows);
      CAPTURE(columns);
      MatrixXd M = rng.matrix(rows, columns);
      for (Index i = 0; i < rows; ++i)
        for (Index j = 0; j < columns; ++j)
          if (rng.chance(0.4)) M(i, j) = 0;
      const Eigen::VectorXd row = random_units(rng, rows), column = random_units(rng, columns);
      const MatrixXd one = scaled(M),
                     other = scaled(MatrixXd(row.asDiagonal() * M * column.asDiagonal()));
      for (Index i = 0; i < rows; ++i)
        for (Index j = 0; j < columns; ++j) {
          if (M(i, j) == 0) CHECK(other(i, j) == 0);
          // Both factors of an entry are rounded to powers of two.
          else
            CHECK(std::abs(std::log2(std::abs(other(i, j) / one(i, j)))) <= 2);
        }
      const MatrixXd units = scaled(MatrixXd(row * column.transpose()));
      CHECK((units.array() >= 0.5).all());
      CHECK((units.array() <= 2).all());
    }
}

TEST_CASE("similarity scaling: parts in series are coupled as strongly as the faster of each two") {
  // Three lags of 1e-7, 550 and 5e-12 rad/s, each driven by the one before.
  const MatrixXd A{{-1e-7, 0, 0}, {550, -550, 0}, {0, 5e-12, -5e-12}};
  MatrixXd scaled = A;
  const Eigen::VectorXd d = linalg::similarity_scaling_of_parts(scaled);
  for (const double coupling : {scaled(1, 0), scaled(2, 1)}) {
    CHECK(coupling >= 275);
    CHECK(coupling <= 1100);
  }
  CHECK(MatrixXd(d.cwiseInverse().asDiagonal() * A * d.asDiagonal()) == scaled);
  // Diagonal entries that are rounding of a feedthrough have no rate.
  MatrixXd direct{{9e-17, 0, 0}, {-0.4, -0.4, 0}, {0.8, 0, -1.4e-16}};
  linalg::similarity_scaling_of_parts(direct);
  CHECK(std::abs(direct(1, 0)) >= 0.2);
  CHECK(std::abs(direct(2, 0)) >= 0.2);
}
