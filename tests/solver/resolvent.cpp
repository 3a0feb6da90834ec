#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/close.hpp"

/// Blocks without modal form: (s - A)^-1 of three and more states, with pivots in other rows.
namespace {

using titop::Lti;
using titop::Precision;
using titop_test::relative;
using Complex = std::complex<double>;

constexpr Precision kAll[] = {Precision::standard, Precision::refined, Precision::twofold,
                              Precision::digits50, Precision::as_needed};

titop::System compiled(const Lti& filter, bool closed) {
  titop::Diagram d("one filter");
  const auto u = d.input("u");
  const auto K = d.add("K", filter);
  if (closed)
    K.in = u + K.out;
  else
    K.in = u;
  d.output("y") = K.out;
  return titop::compile(d);
}

}  // namespace

TEST_CASE("Two swaps of rows behind one another: 2 by hand") {
  Lti K{.A = Eigen::MatrixXd::Zero(3, 3),
        .B = Eigen::MatrixXd::Identity(3, 1),
        .C = Eigen::MatrixXd::Identity(3, 3).bottomRows(1)};
  K.A(0, 0) = K.A(1, 0) = -1, K.A(2, 1) = -4;
  // At s = 1: 2 x1 = 1, x1 + x2 = 0, 4 x2 + x3 = 0.
  const titop::System system = compiled(K, false);
  for (const Precision p : kAll) CHECK(relative(system.transfer(1, p)(0, 0), Complex(2)) <= 1e-15);
}

TEST_CASE("A companion matrix with a loop that leaves an integrator") {
  Lti K{.A = Eigen::MatrixXd::Zero(3, 3),
        .B = Eigen::MatrixXd::Identity(3, 1),
        .C = Eigen::MatrixXd::Zero(1, 3)};
  K.A << -2.2, -0.41, -0.02, 1, 0, 0, 0, 1, 0;
  K.C(0, 2) = 0.02;
  // 0.02 / p, p = s^3 + 2.2 s^2 + 0.41 s + 0.02; the loop takes 0.02 from p.
  const Complex s(0, 1e-5), y = 0.02 / (s * (s * (s + 2.2) + 0.41));
  const titop::System system = compiled(K, true);
  for (const Precision p :
       {Precision::refined, Precision::twofold, Precision::digits50, Precision::as_needed})
    CHECK(relative(system.transfer(s, p)(0, 0), y) <= 1e-12);
  // 1 - 0.02 / p leaves 2e-4 of 1 at this s.
  CHECK(relative(system.transfer(s, Precision::standard)(0, 0), y) <= 1e-11);
}
