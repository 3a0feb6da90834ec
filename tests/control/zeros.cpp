#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <titop/analysis/control/zeros.hpp>
#include <titop/graph/error.hpp>

#include "control/transfer_functions.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// Transmission zeros against polynomials and models made of known zeros.

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;

namespace {

/// Largest distance of the expected zeros from the nearest found, relative; 1 for another number.
double off(const StateSpace& m, std::vector<Complex> expected) {
  const Eigen::VectorXcd z = transmission_zeros(m);
  if (static_cast<std::size_t>(z.size()) != expected.size()) return 1;
  std::vector<Complex> left(z.begin(), z.end());
  double worst = 0;
  for (const Complex& e : expected) {
    const auto near = std::min_element(left.begin(), left.end(), [&](Complex a, Complex b) {
      return std::abs(a - e) < std::abs(b - e);
    });
    worst = std::max(worst, std::abs(*near - e) / std::max(std::abs(e), 1e-3));
    left.erase(near);
  }
  return worst;
}

/// The same model in other states.
StateSpace turned(const StateSpace& m, Rng& rng) {
  const MatrixXd T =
      rng.matrix(m.order(), m.order()) + 3 * MatrixXd::Identity(m.order(), m.order());
  StateSpace t = m;
  t.A = T.inverse() * m.A * T, t.B = T.inverse() * m.B, t.C = m.C * T;
  return t;
}

}  // namespace

TEST_CASE("single loops: the roots of the numerator, of any relative degree") {
  Rng rng(5);
  CHECK(off(ratio({1}, {1, 2, 3, 4}), {}) == 0);
  CHECK(off(ratio({2, 6}, {1, 2, 3, 4}), {-3.0}) <= 1e-13);
  CHECK(off(ratio({1, 0, 4}, {1, 2, 3, 4}), {{0, 2}, {0, -2}}) <= 1e-13);
  CHECK(off(ratio({1, -1, 0, 0}, {1, 2, 3, 4}), {1.0, 0.0, 0.0}) <= 1e-6);
  CHECK(off(ratio({1, 5, 6, 0}, {1, 0, 0, 0}), {-2.0, -3.0, 0.0}) <= 1e-13);
  CHECK(off(ratio({3}, {1}), {}) == 0);
  for (int k = 0; k < 20; ++k) {
    const double a = rng.between(-3, 3), w = rng.between(0.1, 50), x = rng.between(-1, 1);
    // (s - a) ((s - x)^2 + w^2) over s^5 + ...
    const StateSpace m = ratio({1, -a - 2 * x, x * x + w * w + 2 * a * x, -a * (x * x + w * w)},
                               {1, 7, 30, 9, 4, 1});
    CHECK(off(turned(m, rng), {a, {x, w}, {x, -w}}) <= 1e-8);
  }
}

TEST_CASE("two inputs and outputs: the zero of no entry") {
  // [2 / (s + 1), 3 / (s + 2); 1 / (s + 1), 1 / (s + 1)] has a zero at +1.
  StateSpace m;  // states: 1/(s+1) of u1, 1/(s+2) of u2, 1/(s+1) of u2
  m.A = Eigen::Vector3d(-1, -2, -1).asDiagonal();
  m.B = MatrixXd(3, 2), m.C = MatrixXd(2, 3), m.D = MatrixXd::Zero(2, 2);
  m.B << 1, 0, 0, 1, 0, 1;
  m.C << 2, 3, 0, 1, 0, 1;
  CHECK(off(m, {1.0}) <= 1e-14);
  Rng rng(8);
  CHECK(off(turned(m, rng), {1.0}) <= 1e-12);
}

TEST_CASE("more outputs than inputs, and modes that nothing sees") {
  StateSpace m = ratio({1, 3}, {1, 2, 5, 1});
  m.C = (MatrixXd(2, 3) << m.C, 2 * m.C).finished(), m.D = MatrixXd::Zero(2, 1);
  CHECK(off(m, {-3.0}) <= 1e-13);  // the same zero in both outputs
  m.C.row(1) << 1, 0, 0;
  CHECK(off(m, {}) == 0);  // in one only
  StateSpace hidden = ratio({1}, {1, 2});
  hidden.A = (MatrixXd(2, 2) << hidden.A, 0, 0, -7).finished();
  hidden.B = (MatrixXd(2, 1) << hidden.B, 0).finished();
  hidden.C = (MatrixXd(1, 2) << hidden.C, 1).finished();
  CHECK(off(hidden, {-7.0}) <= 1e-14);  // an invariant zero
}

TEST_CASE("zeros of a structure: its modes with the sensor held") {
  // Two masses, force on and position of the first: the zero is the second on its spring.
  StateSpace m;
  m.A = MatrixXd::Zero(4, 4), m.B = MatrixXd::Zero(4, 1), m.C = MatrixXd::Zero(1, 4);
  m.D = MatrixXd::Zero(1, 1);
  m.A.topRightCorner(2, 2).setIdentity();
  m.A.bottomLeftCorner(2, 2) << -8, 8, 4e2, -4e2;  // masses 1 and 1 / 50, spring 8
  m.B(2, 0) = 1, m.C(0, 0) = 1;
  CHECK(off(m, {{0, 20}, {0, -20}}) <= 1e-14);
}

TEST_CASE("mistakes") {
  StateSpace m = ratio({1}, {1, 1});
  m.A(0, 0) = NAN;
  CHECK(error_of([&] { transmission_zeros(m); }).has(Code::not_finite));
  m.A = MatrixXd::Zero(2, 2);
  CHECK(error_of([&] { transmission_zeros(m); }).has(Code::size));
}
