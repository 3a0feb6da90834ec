#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/schur.hpp>
#include <titop/titop.hpp>

/// Poles whose eigenvectors are no basis: poles without a verdict are kept.

using namespace titop;
using Eigen::MatrixXd;

TEST_CASE("minimal: critical damping beside a filter of the same pole, with outputs and without") {
  for (const double k : {0.25, 1.0, 4.0, 16.0})
    for (const bool seen : {false, true}) {
      CAPTURE(k);
      CAPTURE(seen);
      Diagram d{"critical"};
      auto u = d.input("u");
      auto a = d.add("a", SpringMass{.mass = 1, .stiffness = k, .damping = 2 * std::sqrt(k)});
      auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 3});
      auto f = d.add("f", Lti{.A = MatrixXd{{-std::sqrt(k)}},
                              .B = MatrixXd{{1.0}},
                              .C = MatrixXd{{1.0}},
                              .D = MatrixXd{{0.0}}});
      ground(a);
      ground(b);
      a.child.force = u;
      b.child.force = u;
      f.in = u;
      if (seen) d.output("y") = 1.0 * a.stretch + 1.0 * b.stretch + f.out;
      // The filter adds nothing to the double pole that u moves: 2 + 2 states.
      const System s = compile(d);
      CHECK(s.state_space().order() >= 4);
      CHECK(s.order_verdict().lowest <= 4);
      CHECK(s.order_verdict().highest >= 4);
    }
}

TEST_CASE(
    "minimal: two equal systems in series, on which the QR iteration goes round in a circle") {
  const MatrixXd A{{3, 0}, {4, 2}}, B{{-1}, {-1}}, C{{1, -1}};
  MatrixXd both = MatrixXd::Zero(4, 4);  // scaled as `minimize` does
  both << A, MatrixXd::Zero(2, 2), 4 * B * C, A;
  // Poles 2 and 3, each twice: eps^(1/2) of them is all that double has.
  std::vector<double> poles;
  for (const std::complex<double> s : titop::linalg::eigenvalues(both)) {
    CHECK(std::abs(s.imag()) <= 1e-6);
    poles.push_back(s.real());
  }
  std::sort(poles.begin(), poles.end());
  REQUIRE(poles.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK(std::abs(poles[i] - (i < 2 ? 2 : 3)) <= 1e-6);
  const titop::linalg::Eigensystem e = titop::linalg::eigensystem(both);
  CHECK((both * e.V - e.V * e.values.asDiagonal()).norm() <= 1e-13 * both.norm());
  const titop::linalg::Schur schur = titop::linalg::schur(both);
  CHECK((schur.Q * schur.T * schur.Q.adjoint() - both).norm() <= 1e-13 * both.norm());

  Diagram d{"series"};
  const auto u = d.input("u");
  const auto a = d.add("a", Lti{.A = A, .B = B, .C = C}),
             b = d.add("b", Lti{.A = A, .B = B, .C = C});
  a.in = u;
  b.in = a.out;
  d.output("y") = b.out;
  const System s = compile(d);
  // C (s - A)^-1 B = -1 / (s - 3) + (s + 1) / ((s - 2) (s - 3)).
  for (const std::complex<double> z : {std::complex<double>(0, 1), {0, 30}, {1, 0.5}}) {
    const std::complex<double> g = 3.0 / ((z - 2.0) * (z - 3.0));
    CHECK(std::abs(s.state_space().transfer(z)(0, 0) - g * g) <= 1e-13 * std::abs(g * g));
  }
}
