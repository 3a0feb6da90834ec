#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// The H-infinity norm against closed forms, and against the gain on a fine grid.

using namespace titop;
using Eigen::MatrixXd;
using std::numbers::pi;

namespace {

/// Modes qdd + 2 xi omega qd + omega^2 q = b u, y = sum of c q.
StateSpace modes(const Eigen::VectorXd& omega, const Eigen::VectorXd& xi, const MatrixXd& b,
                 const MatrixXd& c) {
  const Eigen::Index n = omega.size();
  StateSpace m;
  m.A = MatrixXd::Zero(2 * n, 2 * n);
  m.A.topRightCorner(n, n).setIdentity();
  m.A.bottomLeftCorner(n, n) = (-omega.cwiseAbs2()).asDiagonal();
  m.A.bottomRightCorner(n, n) = (-2 * xi.cwiseProduct(omega)).asDiagonal();
  m.B = MatrixXd::Zero(2 * n, b.cols()), m.B.bottomRows(n) = b;
  m.C = MatrixXd::Zero(c.rows(), 2 * n), m.C.leftCols(n) = c;
  m.D = MatrixXd::Zero(c.rows(), b.cols());
  return m;
}

StateSpace one_mode(double omega, double xi) {
  const MatrixXd one = MatrixXd::Ones(1, 1);
  return modes(Eigen::VectorXd::Constant(1, omega), Eigen::VectorXd::Constant(1, xi), one, one);
}

/// 1 / (s^2 + 2 xi omega s + omega^2)
double peak_of(double omega, double xi) {
  return 1 / (omega * omega * 2 * xi * std::sqrt(1 - xi * xi));
}

double off(double x, double exact) { return std::abs(x / exact - 1); }

StateSpace direct(double a, double b, double c, double d) {
  StateSpace m;
  m.A = MatrixXd::Constant(1, 1, a), m.B = MatrixXd::Constant(1, 1, b);
  m.C = MatrixXd::Constant(1, 1, c), m.D = MatrixXd::Constant(1, 1, d);
  return m;
}

}  // namespace

TEST_CASE("one mode, of any damping and frequency") {
  for (const double xi : {0.6, 0.1, 1e-3, 1e-6})
    for (const double omega : {1e-3, 1.0, 2e4}) {
      CAPTURE(xi);
      CAPTURE(omega);
      const HinfNorm n = norm_hinf(one_mode(omega, xi));
      CHECK(off(n.value, peak_of(omega, xi)) <= 1e-14 / xi);
      CHECK(off(n.omega, omega * std::sqrt(1 - 2 * xi * xi)) <= 1e-10);
      CHECK(n.others.empty());
    }
  const HinfNorm n = norm_hinf(one_mode(2, 0.9));  // overdamped for a peak: the static gain
  CHECK(off(n.value, 0.25) <= 1e-14);
  CHECK(n.omega == 0);
}

TEST_CASE("a band: its inside, its ends, and beyond a pole on the axis") {
  const StateSpace m = one_mode(10, 0.01);
  const auto gain = [](double w) {
    return 1 / std::abs(std::complex<double>(100 - w * w, 0.2 * w));
  };
  CHECK(off(norm_hinf(m, {.band_hz = {1, 2}}).value, peak_of(10, 0.01)) <= 1e-12);
  const HinfNorm below = norm_hinf(m, {.band_hz = {0, 1}}),
                 above = norm_hinf(m, {.band_hz = {2, 9}});
  CHECK(off(below.value, gain(2 * pi)) <= 1e-13);
  CHECK(off(below.omega, 2 * pi) <= 1e-15);
  CHECK(off(above.value, gain(4 * pi)) <= 1e-13);
  const HinfNorm undamped = norm_hinf(one_mode(10, 0), {.band_hz = {2, 9}});
  CHECK(off(undamped.value, 1 / (16 * pi * pi - 100)) <= 1e-13);
}

TEST_CASE("direct terms and poles on the right") {
  // (s + 3) / (s + 1): 3 at 0. (3 s + 1) / (s + 1): 3 at infinity.
  CHECK(off(norm_hinf(direct(-1, 2, 1, 1)).value, 3) <= 1e-14);
  const HinfNorm high = norm_hinf(direct(-1, -2, 1, 3));
  CHECK(off(high.value, 3) <= 1e-14);
  CHECK(std::isinf(high.omega));
  CHECK(off(norm_hinf(direct(1, 1, 1, 0)).value, 1) <= 1e-14);  // 1 / (s - 1)
  StateSpace gain;
  gain.A.resize(0, 0), gain.B.resize(0, 2), gain.C.resize(1, 0), gain.D = MatrixXd{{3, 4}};
  CHECK(off(norm_hinf(gain).value, 5) <= 1e-15);
}

TEST_CASE("a constant gain is no single peak, a flat one is") {
  // (s - 1) / (s + 1), and (s^2 - 0.6 s + 9) / (s^2 + 0.6 s + 9): 1 everywhere.
  CHECK(norm_hinf(direct(-1, 1, -2, 1)).others.size() == 1);
  StateSpace pass = one_mode(3, 0.1);
  pass.C = MatrixXd{{0, -1.2}}, pass.D = MatrixXd::Ones(1, 1);
  for (const HinfOptions& band : {HinfOptions{}, {.band_hz = {0.1, 2}}, {.band_hz = {1, 1e9}}}) {
    const HinfNorm n = norm_hinf(pass, band);
    CHECK(off(n.value, 1) <= 1e-12);
    CHECK(n.others.size() == 1);
  }
  // 1 / (s + 1) and (3 s + 1) / (s + 1), at ends of bands, too.
  for (const double low : {0.0, 0.2}) {
    CHECK(norm_hinf(direct(-1, 1, 1, 0), {.band_hz = {low, 5}}).others.empty());
    CHECK(norm_hinf(direct(-1, -2, 1, 3), {.band_hz = {low, 5}}).others.empty());
    CHECK(norm_hinf(direct(-1, -2, 1, 3), {.band_hz = {low, HUGE_VAL}}).others.empty());
  }
  // A peak 1e-7 of its frequency from an end of the band; it has fallen by 1e-8 at 1e-5 of that.
  const double top = 3 * std::sqrt(1 - 2 * 0.01) / (2 * pi);
  CHECK(norm_hinf(one_mode(3, 0.1), {.band_hz = {0.1, top * (1 + 1e-7)}}).others.empty());
  CHECK(norm_hinf(one_mode(3, 0.1), {.band_hz = {top * (1 - 1e-7), 2}}).others.empty());
  // Butterworth's low pass of order 4: |H|^2 = 1 / (1 + omega^8).
  StateSpace flat;
  const double a = 2 * (std::cos(pi / 8) + std::cos(3 * pi / 8)), b = 2 + std::sqrt(2.0);
  flat.A = MatrixXd{{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, {-1, -a, -b, -a}};
  flat.B = MatrixXd{{0}, {0}, {0}, {1}}, flat.C = MatrixXd{{1, 0, 0, 0}};
  flat.D = MatrixXd::Zero(1, 1);
  const HinfNorm n = norm_hinf(flat);
  CHECK(off(n.value, 1) <= 1e-12);
  CHECK(n.others.empty());
}

TEST_CASE("two narrow peaks of one height, whose crossings rounding merges") {
  for (const double xi : {1e-6, 1e-9, 1e-10, 1e-11})
    for (const double scale : {1.0, 3e3, 2e4}) {  // omega^2 is exact, else the heights differ
      CAPTURE(xi);
      CAPTURE(scale);
      const Eigen::Vector2d omega = scale * Eigen::Vector2d(2, 7);
      const MatrixXd b = omega.cwiseAbs2().asDiagonal();
      const HinfNorm n =
          norm_hinf(modes(omega, Eigen::Vector2d(xi, xi), b, MatrixXd::Identity(2, 2)));
      CHECK(off(n.value, 1 / (2 * xi)) <= 1e-14 / xi);
      CHECK(n.others.size() == 1);
    }
}

TEST_CASE("matrices: singular values and vectors of turned channels") {
  // y = Q diag(g1, g2) R u with orthogonal Q and R.
  const auto turn = [](double a) {
    return MatrixXd{{std::cos(a), -std::sin(a)}, {std::sin(a), std::cos(a)}};
  };
  const Eigen::Vector2d omega(3, 5), xi(0.02, 0.05);
  const StateSpace m = modes(omega, xi, turn(0.4), turn(-1.1));
  const HinfNorm n = norm_hinf(m);
  CHECK(off(n.value, peak_of(3, 0.02)) <= 1e-12);
  const Eigen::MatrixXcd H = m.transfer({0, n.omega});
  CHECK((H * n.right - n.value * n.left).norm() <= 1e-12 * n.value);
  const std::complex<double> s(0, n.omega), g2 = 1.0 / (s * s + 0.5 * s + 25.0);
  CHECK(off(n.second, std::abs(g2)) <= 1e-12);
}

TEST_CASE(
    "forty modes: never below the gain on a grid, nor above it by more than the grid's error") {
  titop_test::Rng rng(5);
  for (int scene = 0; scene < 3; ++scene) {
    const Eigen::Index n = 40;
    const Eigen::VectorXd omega =
        Eigen::VectorXd::NullaryExpr(n, [&] { return std::pow(10, rng.between(0, 2)); });
    const Eigen::VectorXd xi = Eigen::VectorXd::Constant(n, 0.002);
    const MatrixXd b = rng.matrix(n, 2), c = rng.matrix(3, n);
    const StateSpace m = modes(omega, xi, b, c);
    const HinfNorm found = norm_hinf(m);
    double largest = 0;
    for (Eigen::Index i = 0; i < n; ++i)
      for (int k = -40; k <= 40; ++k) {  // steps of a tenth of the half bandwidth
        const std::complex<double> s(0, omega(i) * (1 + 0.0002 * k));
        Eigen::VectorXcd g(n);
        for (Eigen::Index j = 0; j < n; ++j)
          g(j) = 1.0 / (s * s + 2 * xi(j) * omega(j) * s + omega(j) * omega(j));
        const Eigen::MatrixXcd H = c * g.asDiagonal() * b;
        // The largest singular value of two columns, by hand.
        const Eigen::Matrix2cd G = H.adjoint() * H;
        const double t = G.trace().real(), d = G.determinant().real();
        largest = std::max(largest, std::sqrt((t + std::sqrt(std::max(0.0, t * t - 4 * d))) / 2));
      }
    CHECK(found.value >= largest * (1 - 1e-12));
    CHECK(found.value <= largest * (1 + 0.003));  // (0.1 / 2)^2 of a resonance's top
  }
}

TEST_CASE("two peaks of one height are both named") {
  // The same stiffness and damping ratio, other masses: peaks of one height at other frequencies.
  const Eigen::Vector2d omega(2, 7), xi(0.03, 0.03);
  const MatrixXd b = omega.cwiseAbs2().asDiagonal();
  const HinfNorm n = norm_hinf(modes(omega, xi, b, MatrixXd::Identity(2, 2)));
  REQUIRE(n.others.size() == 1);
  const double low = std::min(n.omega, n.others[0]), high = std::max(n.omega, n.others[0]);
  CHECK(off(low, 2 * std::sqrt(1 - 2 * 0.0009)) <= 1e-5);
  CHECK(off(high, 7 * std::sqrt(1 - 2 * 0.0009)) <= 1e-5);
}

TEST_CASE("matrices that do not fit each other are refused") {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  const StateSpace m{.A = -one, .B = Eigen::MatrixXd::Ones(2, 1), .C = one, .D = one};
  CHECK(titop_test::says(titop_test::error_of([&] { norm_hinf(m); }), Code::size, {"B", "2 x 1"}));
  CHECK(
      titop_test::says(titop_test::error_of([&] { m.transfer(1.0); }), Code::size, {"B", "1 x 1"}));
}

TEST_CASE("models without a norm are refused") {
  using titop_test::error_of;
  using titop_test::says;
  const Error undamped = error_of([] { norm_hinf(one_mode(10, 0)); });
  CHECK(undamped.has(Code::singular));
  CHECK(std::string(undamped.what()).find("+10j") != std::string::npos);
  CHECK(error_of([] { norm_hinf(direct(0, 1, 1, 0)); }).has(Code::singular));
  CHECK(error_of([] { norm_hinf(one_mode(1, 0.1), {.band_hz = {3, 2}}); }).has(Code::bad_value));
  for (MatrixXd StateSpace::*matrix :
       {&StateSpace::A, &StateSpace::B, &StateSpace::C, &StateSpace::D})
    for (const double bad : {std::nan(""), HUGE_VAL}) {
      StateSpace broken = one_mode(1, 0.1);
      (broken.*matrix)(0, 0) = bad;
      CHECK(says(error_of([&] { norm_hinf(broken); }), Code::not_finite, {"finite"}));
    }
  StateSpace large;
  large.A = -MatrixXd::Identity(601, 601);
  large.B = MatrixXd::Ones(601, 1), large.C = MatrixXd::Ones(1, 601),
  large.D = MatrixXd::Zero(1, 1);
  CHECK(says(error_of([&] { norm_hinf(large); }), Code::bad_value, {"601", "600", "Scene"}));
}

TEST_CASE("a narrow peak above the direct term") {
  // (s^2 + 2 zz wz s + wz^2) (s + b) / ((s^2 + 2 zp wp s + wp^2) (s + a)): 1 at infinity, and
  // beside a pole and a zero that nearly cancel 1.30725 (in 50 digits).
  const double a = 0.7265253112684847, b = 0.05165429358995563, wp = 3.1132656370273737,
               zp = 2.339301048697969e-07, wz = 3.113264987783945, zz = -2.884477859470711e-08;
  const double p1 = 2 * zp * wp + a, p2 = wp * wp + 2 * zp * wp * a, p3 = wp * wp * a,
               q1 = 2 * zz * wz + b, q2 = wz * wz + 2 * zz * wz * b, q3 = wz * wz * b;
  StateSpace m;
  m.A = (MatrixXd(3, 3) << 0, 1, 0, 0, 0, 1, -p3, -p2, -p1).finished();
  m.B = MatrixXd::Zero(3, 1), m.B(2, 0) = 1;
  m.C = (MatrixXd(1, 3) << q3 - p3, q2 - p2, q1 - p1).finished();
  m.D = MatrixXd::Ones(1, 1);
  const HinfNorm all = norm_hinf(m), band = norm_hinf(m, {.band_hz = {0, 10}});
  CHECK(all.value >= 1.30725200318);
  CHECK(std::abs(all.value / band.value - 1) <= 1e-6);
  CHECK(std::abs(all.omega / 3.113266446931938 - 1) <= 1e-7);
}
