#include "../support/half_ties.hpp"

#include <doctest/doctest.h>

/// Ties of three of six: the same transfer by all roads.

using namespace half_ties;
using namespace titop;

namespace {

MatrixXcd of_matrices(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C, const MatrixXd& D,
                      std::complex<double> s) {
  const MatrixXcd Z = s * MatrixXd::Identity(A.rows(), A.rows()) - A;
  MatrixXcd H = D.cast<std::complex<double>>();
  if (A.rows() > 0) H += C * Z.partialPivLu().solve(MatrixXcd(B.cast<std::complex<double>>()));
  return H;
}

MatrixXcd by_apply(const System& system, std::complex<double> s) {
  const Index n = system.order();
  const auto m = static_cast<Index>(system.inputs().size());
  const auto p = static_cast<Index>(system.outputs().size());
  MatrixXd all(n + p, n + m);
  for (Index j = 0; j < n + m; ++j) {
    const VectorXd known = VectorXd::Unit(n + m, j);
    const auto [xdot, y] = system.apply(known.head(n), known.tail(m));
    all.col(j) << xdot, y;
  }
  return of_matrices(all.topLeftCorner(n, n), all.topRightCorner(n, m), all.bottomLeftCorner(p, n),
                     all.bottomRightCorner(p, m), s);
}

/// Relative error of nonzero values.
double error(const MatrixXcd& a, const MatrixXcd& exact) {
  const double size = exact.size() ? exact.cwiseAbs().maxCoeff() : 0;
  return (a - exact).cwiseAbs().maxCoeff() / (size > 1e-12 ? size : 1);
}

}  // namespace

TEST_CASE("a body turned by another, and held at a point beside: velocity = omega x lever") {
  const System system = compile(turned());
  // Two inertias of 1 and a mass of 1 at a distance of 1 about z: a torque of 1 for a second turns
  // them by 1/3 rad/s, and b at (0, 1, 0) goes by (0, 0, 1/3) x (0, 1, 0).
  VectorXd exact(6);
  exact << -1. / 3, 0, 0, 0, 0, 1. / 3;
  const std::complex<double> s(0.7, 1.1);
  const MatrixXcd H = exact.cast<std::complex<double>>() / s;
  const StateSpace& m = system.state_space();
  CHECK(error(system.transfer(s), H) <= 1e-12);
  CHECK(error(of_matrices(m.A, m.B, m.C, m.D, s), H) <= 1e-12);
  CHECK(error(by_apply(system, s), H) <= 1e-12);
  const Trajectory t = simulate(system, Excitation::step(VectorXd::Ones(1)),
                                {.step = 0.01, .until = 1, .stepper = Stepper::rk4});
  CHECK((t.y.rightCols(1) - exact).cwiseAbs().maxCoeff() <= 1e-12);
}

namespace {

/// The output at t after a step of all inputs: Taylor series of M z'' + G z' + K z = B u.
VectorXd after_step(const Oracle& o, double t) {
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Index n = o.M.rows();
  const auto inverse = o.M.ldlt();
  Wide F = Wide::Zero(2 * n, 2 * n), w = Wide::Zero(2 * n, 1), g = w;
  F.topRightCorner(n, n).setIdentity();
  F.bottomLeftCorner(n, n) = -inverse.solve(o.K).cast<long double>();
  F.bottomRightCorner(n, n) = -inverse.solve(o.G).cast<long double>();
  g.bottomRows(n) = inverse.solve(o.B.rowwise().sum()).cast<long double>();
  const int steps =
      1 + static_cast<int>(t * static_cast<double>(F.cwiseAbs().rowwise().sum().maxCoeff()));
  const long double h = static_cast<long double>(t) / steps;
  for (int i = 0; i < steps; ++i) {
    Wide term = h * (F * w + g);
    for (int k = 2; k < 25; ++k) w += term, term = (h / k * (F * term)).eval();
  }
  return o.C * w.bottomRows(n).cast<double>();
}

/// By steps of `apply`: 25 of 0.04 over a bound of the highest frequency.
double simulation_error(const System& system, const Oracle& o) {
  if (o.M.rows() == 0) return 0;
  const MatrixXd squares = o.M.ldlt().solve(o.K);
  const double until = 1 / std::sqrt(std::max(1.0, squares.cwiseAbs().rowwise().sum().maxCoeff()));
  const Trajectory t = simulate(system, Excitation::step(VectorXd::Ones(6)),
                                {.step = until / 25, .until = until, .stepper = Stepper::rk4});
  return error(t.y.rightCols(1).cast<std::complex<double>>(),
               after_step(o, until).cast<std::complex<double>>());
}

/// Compiles and compares at two s and in time; false if the scene is near singular, and is not
/// judged.
bool right_by_all_roads(const Sketch& sketch) {
  const Oracle o = oracle(sketch);
  if (o.gap < 1e-4) return false;
  const System system = compile(diagram(sketch));
  const StateSpace& m = system.state_space();
  for (const std::complex<double> s : {std::complex<double>(0.3, 1.3), {0.5, 6}}) {
    const MatrixXcd H = o.rate(s);
    CHECK(error(system.transfer(s), H) <= 1e-8);
    CHECK(error(of_matrices(m.A, m.B, m.C, m.D, s), H) <= 1e-8);
    CHECK(error(by_apply(system, s), H) <= 1e-8);
  }
  CHECK(simulation_error(system, o) <= 1e-6);
  CHECK(system.certificate().residual <= 1e-9);
  return true;
}

}  // namespace

TEST_CASE("ties of any directions, at one to three places of a loop: maximal coordinates") {
  Rng rng(46);
  int judged = 0;
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    judged += right_by_all_roads(draw(rng, i % 2 == 1));
  }
  CHECK(judged >= 55);
}

TEST_CASE("ties of any directions, closed through slides: maximal coordinates") {
  Rng rng(69);
  int judged = 0, slides = 0;
  for (int i = 0; i < 80; ++i) {
    CAPTURE(i);
    const Sketch sketch = draw(rng, i % 2 == 1, true);
    for (const HalfTie& t : sketch.ties) slides += t.slide;
    judged += right_by_all_roads(sketch);
  }
  CHECK(slides >= 40);
  CHECK(judged >= 70);
}

TEST_CASE("ties of all 63 sets of directions, at one, two and three places") {
  Rng rng(63);
  int judged = 0;
  for (int mask = 1; mask < 64; ++mask)
    for (std::size_t places = 1; places <= 3; ++places)
      for (const bool flexible : {false, true}) {
        Sketch sketch = draw(rng, flexible);
        for (std::size_t k = 0; k < std::min(places, sketch.ties.size()); ++k)
          tie_again(sketch, sketch.ties[sketch.ties.size() - 1 - k], mask);
        CAPTURE(mask);
        CAPTURE(places);
        CAPTURE(flexible);
        judged += right_by_all_roads(sketch);
      }
  CHECK(judged >= 340);
}
