#include <doctest/doctest.h>

#include <cmath>
#include <titop/graph/linalg/dense.hpp>

using Eigen::MatrixXd;
using titop::linalg::skeel_radius;

namespace {

constexpr double kLoose = 3e-3;  ///< "from above, to a few 1e-3"

/// [1, -a; -b, 1]: rho(|L^-1| |L|) = (1 + sqrt|ab|)^2 / |1 - ab|, by hand.
double of_two(double a, double b) {
  const double g = std::sqrt(std::abs(a * b));
  return (1 + g) * (1 + g) / std::abs(1 - a * b);
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
    }
}

TEST_CASE("Margin of a loop that a zero cuts open is 1, in any order of its unknowns") {
  CHECK(skeel_radius(MatrixXd{{1, -5}, {0, 1}}) == 1);
  // Rounding in the elimination may put something in the place of a zero.
  within(skeel_radius(MatrixXd{{1, 0, 0}, {-2, 1, 0}, {3, -7, 1}}), 1);
  within(skeel_radius(MatrixXd{{-2, 3, 1}, {1, -7, 0}, {0, 1, 0}}), 1);  // rows and columns turned
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
}
