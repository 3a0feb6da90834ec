#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/skeel.hpp>
#include <vector>

#include "support/random_matrix.hpp"

using Eigen::MatrixXd;
using titop::linalg::skeel_radius;

namespace {

constexpr double kLoose = 3e-3;  ///< "from above, to a few 1e-3"

/// [1, -a; -b, 1]: |L^-1| |L| = [1 + |ab|, 2|a|; 2|b|, 1 + |ab|] / |1 - ab|, whose larger
/// eigenvalue is (1 + sqrt|ab|)^2 / |1 - ab|.
double of_two(double a, double b) {
  const double g = std::sqrt(std::abs(a * b));
  return (1 + g) * (1 + g) / std::abs(1 - a * b);
}

/// I - a P, P the cyclic shift of n: |L^-1| = sum_k |a|^k P^k / |1 - a^n|, k < n, and |L| = I + |a|
/// P have the vector of ones in common: (1 + |a|) (1 + |a| + ... + |a|^(n-1)) / |1 - a^n|. Other
/// gains are other units of the same, with a^n their product.
double of_ring(int n, double product) {
  const double a = std::pow(std::abs(product), 1.0 / n);
  double sum = 0;
  for (int k = 0; k < n; ++k) sum += std::pow(a, k);
  return (1 + a) * sum / std::abs(1 - product);
}

void within(double radius, double exact) {
  CHECK(radius >= exact * (1 - 1e-12));
  CHECK(radius <= exact * (1 + kLoose));
}

}  // namespace

TEST_CASE("Margin of two unknowns that feed each other: as by hand, whatever their units") {
  for (const double a : {1e-12, -0.3, 0.99, 7.0, -1e9})
    for (const double b : {1e-3, 0.5, -2.0}) {
      INFO("a = ", a, ", b = ", b);
      within(skeel_radius(MatrixXd{{1, -a}, {-b, 1}}), of_two(a, b));
      within(skeel_radius(MatrixXd{{1, -a * 1e12}, {-b / 1e12, 1}}), of_two(a, b));
      within(skeel_radius(MatrixXd{{1e200, -a * 1e-50}, {-b * 1e200, 1e-50}}), of_two(a, b));
    }
}

TEST_CASE("Margin of a ring of n equal gains: as by hand") {
  for (const int n : {3, 5, 12, 13, 40})
    for (const double a : {0.25, -0.9, 3.0}) {
      INFO("n = ", n, ", a = ", a);
      MatrixXd L = MatrixXd::Identity(n, n);
      for (int i = 0; i < n; ++i) L(i, (i + 1) % n) = -a;
      within(skeel_radius(L), of_ring(n, std::pow(a, n)));
    }
}

TEST_CASE("Margin of a ring: as by hand in any units, in any order, beside another ring") {
  titop_test::Rng rng(7);
  for (const int n : {2, 3, 6, 13, 60})
    for (const double product : {-0.7, 1e-9, 0.999, 40.0}) {
      CAPTURE(n);
      CAPTURE(product);
      // Units of the unknowns up to 250 orders of magnitude apart, of the equations as well.
      std::vector<int> order(static_cast<std::size_t>(n));
      std::iota(order.begin(), order.end(), 0);
      rng.shuffle(order);
      Eigen::VectorXd row(n), column(n);
      for (double& x : row) x = std::ldexp(1, rng.below(800) - 400);
      for (double& x : column) x = std::ldexp(1, rng.below(800) - 400);
      MatrixXd L = MatrixXd::Zero(n, n);
      for (int i = 0; i < n; ++i) {
        const int r = order[static_cast<std::size_t>(i)], next = (i + 1) % n;
        L(r, i) += row(r) * column(i);
        L(r, next) += (i == 0 ? -product : -1) * row(r) * column(next);
      }
      within(skeel_radius(L), of_ring(n, product));
      MatrixXd two = MatrixXd::Zero(n + 3, n + 3);
      two.topLeftCorner(n, n) =
          row.cwiseInverse().asDiagonal() * L * column.cwiseInverse().asDiagonal();
      two.bottomRightCorner(3, 3) << 1, -0.2, 0, 0, 1, -0.2, -0.2, 0, 1;
      if (n > 2) within(skeel_radius(two), std::max(of_ring(n, product), of_ring(3, 0.008)));
    }
}

TEST_CASE("Margin of a loop that is no ring: the largest eigenvalue, compared with Eigen") {
  titop_test::Rng rng(3);
  for (const int n : {3, 4, 7, 12, 13, 30}) {
    CAPTURE(n);
    MatrixXd L = MatrixXd::Identity(n, n);
    for (double& x : L.reshaped()) x += rng.below(2001) / 1000.0 - 1;
    const MatrixXd product = L.inverse().cwiseAbs() * L.cwiseAbs();
    const double radius =
        Eigen::EigenSolver<MatrixXd>(product, false).eigenvalues().cwiseAbs().maxCoeff();
    CHECK(skeel_radius(L) >= radius * (1 - 1e-9));
    CHECK(skeel_radius(L) <= radius * (1 + kLoose));
  }
}

TEST_CASE("Margin of 0 to 12 unknowns: dense, scaled, permuted and singular matrices") {
  using titop_test::Input;
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  titop_test::Rng rng(5);
  for (int n = 0; n <= 12; ++n)
    for (const Input input : {Input::dense, Input::permuted}) {
      CAPTURE(n);
      CAPTURE(static_cast<int>(input));
      const MatrixXd L = titop_test::random_matrix(rng, input, n);
      double radius = 1;
      if (n > 0) {
        const Wide M = L.cast<long double>(), product = M.inverse().cwiseAbs() * M.cwiseAbs();
        radius = static_cast<double>(
            Eigen::EigenSolver<Wide>(product, false).eigenvalues().cwiseAbs().maxCoeff());
      }
      for (const MatrixXd& in_units : {L, titop_test::scaled(rng, L)}) {
        CHECK(skeel_radius(in_units) >= radius * (1 - 1e-9));
        CHECK(skeel_radius(in_units) <= radius * (1 + kLoose));
      }
    }
  // Within 1 / radius of each entry no matrix is singular; rounding is 3 n^3 eps, growth 8 (as in
  // fronts).
  for (int n = 1; n <= 12; ++n) {
    CAPTURE(n);
    const MatrixXd L = titop_test::random_matrix(rng, Input::singular, n);
    for (const MatrixXd& in_units : {L, titop_test::scaled(rng, L)}) {
      const double radius = skeel_radius(in_units);
      CHECK((radius == 0 || radius >= 1 / (24.0 * n * n * n * 2.2e-16)));
    }
  }
}

TEST_CASE("Margin of a loop that a zero cuts open is 1, in any order of its unknowns") {
  CHECK(skeel_radius(MatrixXd{{1, -5}, {0, 1}}) == 1);
  within(skeel_radius(MatrixXd{{1, 0, 0}, {-2, 1, 0}, {3, -7, 1}}), 1);
  within(skeel_radius(MatrixXd{{-2, 3, 1}, {1, -7, 0}, {0, 1, 0}}), 1);  // rows and columns turned
}

TEST_CASE("Margin of a large loop that zeros cut open is 1, too") {
  // A body with nine springs on it, none of which passes an acceleration on: forces F, reactions f.
  constexpr int n = 9, sum = 2 * n;
  MatrixXd L = MatrixXd::Identity(2 * n + 2, 2 * n + 2);
  L(sum, sum + 1) = -1.01;
  for (int i = 0; i < n; ++i) {
    L(2 * i, 2 * i + 1) = -1;  // f by F
    L(sum + 1, 2 * i) = 1;     // their sum
  }
  within(skeel_radius(L), 1);
  L(3, sum) = -0.4;  // one of them does: a ring of four
  within(skeel_radius(L), of_ring(4, -0.4 * 1.01));
}

TEST_CASE("Margin of two rings of which one drives the other: that of one ring, small and large") {
  for (const int n : {3, 5, 8, 30}) {
    CAPTURE(n);
    MatrixXd L = MatrixXd::Identity(2 * n, 2 * n);
    for (const int ring : {0, n})
      for (int i = 0; i < n; ++i) L(ring + i, ring + (i + 1) % n) = -0.5;
    L(0, n) = 100, L(1, n + 1) = -3, L(2, 2 * n - 1) = 7;
    within(skeel_radius(L), of_ring(n, std::pow(0.5, n)));
  }
}

TEST_CASE("Margin of parts that reach each other one way only is that of the worst part") {
  MatrixXd L = MatrixXd::Identity(5, 5);
  L(0, 3) = -0.5, L(3, 0) = -0.5;  // 9/3 = 3
  L(1, 4) = -0.25, L(4, 1) = -1;   // 2.25/0.75 = 3
  L(2, 2) = 8, L(2, 0) = 100, L(3, 1) = -60;
  within(skeel_radius(L), 3);
  L(4, 1) = -3.61;  // g = 0.95
  within(skeel_radius(L), of_two(0.25, 3.61));
}

TEST_CASE("Margin: a loop without a solution has none") {
  CHECK(skeel_radius(MatrixXd{{1, -2}, {-0.5, 1}}) == 0);
  CHECK(skeel_radius(MatrixXd{{0, 0}, {0, 0}}) == 0);
  CHECK(skeel_radius(MatrixXd{{0, 3}, {0, 5}}) == 0);
  CHECK(skeel_radius(MatrixXd{{0, 3}, {-2, 0}}) == 1);  // one after the other, turned
}
