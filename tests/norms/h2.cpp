#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

/// The H2 norm against closed forms.

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;

namespace {

StateSpace diagonal(const Eigen::VectorXd& poles, const MatrixXd& B, const MatrixXd& C) {
  return {.A = poles.asDiagonal(),
          .B = B,
          .C = C,
          .D = MatrixXd::Zero(C.rows(), B.cols()),
          .states = {},
          .inputs = {},
          .outputs = {}};
}

}  // namespace

TEST_CASE("a lag, two lags, a mode of any damping") {
  const MatrixXd one = MatrixXd::Ones(1, 1);
  for (const double a : {1e-3, 1.0, 1e4})  // 1 / (s + a): 1 / sqrt(2 a)
    CHECK(
        std::abs(norm_h2(diagonal(Eigen::VectorXd::Constant(1, -a), one, one)) * std::sqrt(2 * a) -
                 1) <= 1e-14);
  // Sums of b_i b_j / (a_i + a_j), with three inputs and outputs by columns and rows.
  const MatrixXd B = (MatrixXd(2, 3) << 1, 2, 0, -1, 0.5, 3).finished();
  const MatrixXd C = (MatrixXd(2, 2) << 1, 4, 2, -1).finished();
  double sum = 0;
  const double a[] = {2, 30};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      sum += C.col(i).dot(C.col(j)) * B.row(i).dot(B.row(j)) / (a[i] + a[j]);
  CHECK(std::abs(norm_h2(diagonal(Eigen::Vector2d(-2, -30), B, C)) / std::sqrt(sum) - 1) <= 1e-14);
  for (const double xi : {0.7, 1e-3, 1e-7}) {  // 1 / (s^2 + 2 xi w s + w^2): 1 / sqrt(4 xi w^3)
    constexpr double w = 8;
    StateSpace m =
        diagonal(Eigen::Vector2d::Zero(), Eigen::Vector2d(0, 1), Eigen::RowVector2d(1, 0));
    m.A << 0, 1, -w * w, -2 * xi * w;
    CHECK(std::abs(norm_h2(m) * std::sqrt(4 * xi * w * w * w) - 1) <= 1e-15 / xi + 1e-13);
  }
}

TEST_CASE("infinite norms, and mistakes") {
  const MatrixXd one = MatrixXd::Ones(1, 1);
  StateSpace m = diagonal(Eigen::VectorXd::Zero(1), one, one);
  CHECK(has_mistake(error_of([&] { norm_h2(m); }), Code::singular, {"H2", "0"}));
  m.A(0, 0) = 3;
  CHECK(has_mistake(error_of([&] { norm_h2(m); }), Code::singular, {"3"}));
  m.A(0, 0) = -3, m.D(0, 0) = 1;
  CHECK(error_of([&] { norm_h2(m); }).has(Code::singular));
  m.D(0, 0) = NAN;
  CHECK(error_of([&] { norm_h2(m); }).has(Code::not_finite));
  m.D = MatrixXd::Zero(2, 2);
  CHECK(error_of([&] { norm_h2(m); }).has(Code::size));
}
