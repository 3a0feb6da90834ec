#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "generate/diagrams/lti.hpp"
#include "support/close.hpp"
#include "support/dense_truth.hpp"
#include "support/rng.hpp"

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

namespace {

using titop::generate::LtiKind;
using titop_test::DenseTruth;
using titop_test::Rng;

/// Alone, behind a loop around itself, in a ring with another, or in a loop through a matrix.
titop::Diagram random_place(Rng& rng, LtiKind kind, int states, int place) {
  const int m = 1 + rng.below(3), outputs = place == 0 ? 1 + rng.below(3) : m;
  titop::Diagram d("random");
  const auto u = d.input("u", m);
  const auto K = d.add("K", titop::generate::random_lti(rng, kind, states, m, outputs));
  if (place == 0) {
    K.in = u;
  } else if (place == 1) {
    K.in = u + K.out;
  } else if (place == 2) {
    const LtiKind other = titop::generate::kLtiKinds[rng.below(6)];
    const auto L = d.add("L", titop::generate::random_lti(rng, other, 1 + rng.below(6), m, m));
    K.in = u - L.out;
    L.in = K.out;
  } else {
    const auto G = d.add("G", titop::MatrixGain{rng.matrix(m, outputs)});
    G.in = K.out;
    K.in = u + G.out;
  }
  d.output("y", outputs) = K.out;
  return d;
}

/// The largest difference over the largest entry: one port by one port.
double port_error(const Eigen::MatrixXcd& y, const DenseTruth& truth) {
  if (!y.allFinite()) return HUGE_VAL;
  return (y - truth.transfer).cwiseAbs().maxCoeff() / truth.transfer.cwiseAbs().maxCoeff();
}

/// Error of y by the rounding of every entry of the equations: in double.
double error_of_terms(const Eigen::MatrixXcd& y, const DenseTruth& truth) {
  if (!y.allFinite()) return HUGE_VAL;
  return (y - truth.transfer).cwiseAbs().cwiseQuotient(truth.terms).maxCoeff();
}

}  // namespace

TEST_CASE("0 to 12 states of every kind, in and out of loops, in every precision") {
  const Complex points[] = {0.9, {0, 3}, {0.3, 2}, {0, 1e3}, {-0.5, 0.25}};
  int tried = 0;
  for (int n = 0; n <= 12; ++n)
    for (const LtiKind kind : titop::generate::kLtiKinds)
      for (int place = 0; place < 4; ++place) {
        CAPTURE(n);
        CAPTURE(static_cast<int>(kind));
        CAPTURE(place);
        Rng rng(static_cast<std::uint64_t>(1000 * n + 10 * static_cast<int>(kind) + place));
        const titop::Diagram d = random_place(rng, kind, n, place);
        const titop::System system = titop::compile(d, {.minimize_up_to = 0});
        CHECK(system.certificate().residual <= 1e-9);
        const Complex s = points[rng.below(5)];
        const DenseTruth truth = titop_test::dense_truth(d.graph(), s);
        for (const Precision p : {Precision::refined, Precision::twofold, Precision::digits50})
          CHECK(port_error(system.transfer(s, p), truth) <= 1e-12);
        for (const Precision p : {Precision::standard, Precision::as_needed})
          CHECK(error_of_terms(system.transfer(s, p), truth) <= 1e-12);
        ++tried;
      }
  CHECK(tried == 13 * 6 * 4);
}

TEST_CASE("Far below all poles but those at 0: right or refused") {
  const Complex s(0, 1e-5);
  int right = 0, refused = 0;
  for (int n = 1; n <= 12; ++n)
    for (const LtiKind kind : {LtiKind::integrators, LtiKind::singular})
      for (int place = 0; place < 4; ++place) {
        CAPTURE(n);
        CAPTURE(static_cast<int>(kind));
        CAPTURE(place);
        Rng rng(static_cast<std::uint64_t>(7000 + 100 * n + 10 * static_cast<int>(kind) + place));
        const titop::Diagram d = random_place(rng, kind, n, place);
        const titop::System system = titop::compile(d, {.minimize_up_to = 0});
        const DenseTruth truth = titop_test::dense_truth(d.graph(), s);
        CHECK(port_error(system.transfer(s, Precision::digits50), truth) <= 1e-12);
        for (const Precision p : {Precision::refined, Precision::twofold}) {
          Eigen::MatrixXcd y;
          try {
            y = system.transfer(s, p);
          } catch (const titop::Error& error) {
            CHECK(error.has(titop::Code::singular));
            ++refused;
            continue;
          }
          CHECK(port_error(y, truth) <= 1e-12);
          ++right;
        }
      }
  CHECK(right > 4 * refused);
}
