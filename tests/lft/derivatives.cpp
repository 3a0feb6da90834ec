#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>

#include "lft/n17.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// Derivatives against closed forms, and against central differences of transfers in 50 digits.

using namespace lft_test;
using Eigen::MatrixXcd;
using titop_test::error_of;

namespace {

/// Differences of the transfer in 50 digits, rounded to double: right to about 1e-12.
struct Differences {
  System system;
  std::complex<double> s;
  std::vector<std::string> names;
  Eigen::VectorXd nominal, step;

  MatrixXcd at(const Eigen::VectorXd& p) const {
    ParameterList values;
    for (std::size_t i = 0; i < names.size(); ++i)
      values.emplace_back(names[i], p(static_cast<Eigen::Index>(i)));
    return system.update(values).transfer(s, Precision::digits50);
  }
  /// Richardson of two central differences.
  MatrixXcd first(int i) const {
    const auto central = [&](double h) {
      const Eigen::VectorXd d = h * step(i) * Eigen::VectorXd::Unit(nominal.size(), i);
      return MatrixXcd((at(nominal + d) - at(nominal - d)) / (2 * h * step(i)));
    };
    return (4 * central(0.5) - central(1)) / 3;
  }
  MatrixXcd second(int i, int j) const {
    const auto central = [&](double h) {
      const Eigen::VectorXd a = h * step(i) * Eigen::VectorXd::Unit(nominal.size(), i),
                            b = h * step(j) * Eigen::VectorXd::Unit(nominal.size(), j);
      return MatrixXcd(
          (at(nominal + a + b) - at(nominal + a - b) - at(nominal - a + b) + at(nominal - a - b)) /
          (4 * h * h * step(i) * step(j)));
    };
    return (4 * central(0.5) - central(1)) / 3;
  }
};

double error(const MatrixXcd& a, const MatrixXcd& b) { return (a - b).norm() / b.norm(); }

/// m xdd + c xd + k x = u on the ground.
System oscillator(double m, double c, double k) {
  Diagram d{"oscillator"};
  auto z = d.add(
      "z", SpringMass{
               .mass = d.param("m", m), .stiffness = d.param("k", k), .damping = d.param("c", c)});
  ground(z);
  z.child.force = d.input("u");
  d.output("x") = z.stretch;
  return compile(d);
}

}  // namespace

TEST_CASE("first and second derivatives of the satellite's transfer") {
  const Satellite s{.rates = true};
  const System system = compile(s.diagram());
  const Derivatives g = derivatives(system, s.names);
  Differences f{system,
                {0.3, 1.4},
                s.names,
                Eigen::Vector4d(1000, 0.4, 1.57, 0.005),
                Eigen::Vector4d(1, 0.001, 0.001, 0.0001)};
  for (int i = 0; i < 4; ++i) {
    CAPTURE(s.names[static_cast<std::size_t>(i)]);
    CHECK(error(g.transfer(f.s, s.names[static_cast<std::size_t>(i)]), f.first(i)) <= 1e-10);
  }
  for (const auto& [i, j] : {std::pair(1, 1), {0, 1}, {2, 1}, {2, 2}, {3, 2}}) {
    CAPTURE(i);
    CAPTURE(j);
    const MatrixXcd H =
        g.transfer(f.s, s.names[static_cast<std::size_t>(i)], s.names[static_cast<std::size_t>(j)]);
    CHECK(error(H, f.second(i, j)) <= 1e-8);
  }
}

TEST_CASE("an oscillator: transfer, matrices, pole and H2 norm in closed form") {
  const double m = 2, c = 0.3, k = 8;
  const Derivatives g = derivatives(oscillator(m, c, k), {"m", "k", "c"});
  const std::complex<double> s{0.2, 1.5}, H = 1.0 / (m * s * s + c * s + k);
  CHECK(std::abs(g.transfer(s, "k")(0, 0) + H * H) <= 1e-14 * std::abs(H * H));
  CHECK(std::abs(g.transfer(s, "m", "c")(0, 0) - 2.0 * s * s * s * H * H * H) <=
        1e-13 * std::abs(2.0 * s * s * s * H * H * H));
  CHECK((g.matrices("k").A - Eigen::Matrix2d{{0, 0}, {-1 / m, 0}}).norm() <= 1e-15);
  CHECK((g.matrices("m").A - Eigen::Matrix2d{{0, 0}, {k / m / m, c / m / m}}).norm() <= 1e-15);

  const auto poles = g.poles();
  REQUIRE(poles.size() == 1);
  const std::complex<double> p = poles[0].s, by = -1.0 / (2 * m * p + c);  // d(m p^2 + c p + k) = 0
  CHECK(std::abs(m * p * p + c * p + k) <= 1e-14 * k);
  for (const auto& [i, slope] : {std::pair(0u, p * p * by), {1u, by}, {2u, p * by}})
    CHECK(std::abs(poles[0].slopes[i](0) - slope) <= 1e-13 * std::abs(slope));

  const auto off = [](double x, double exact) { return std::abs(x / exact - 1); };
  const Slopes n = g.h2();  // |H|^2 = 1 / (2 c k)
  CHECK(off(n.value, 1 / std::sqrt(2 * c * k)) <= 1e-13);
  CHECK(std::abs(n.slopes(0)) <= 1e-14);
  CHECK(off(n.slopes(1), -n.value / (2 * k)) <= 1e-12);
  CHECK(off(n.slopes(2), -n.value / (2 * c)) <= 1e-12);
}

TEST_CASE("equal poles split by the eigenvalues of a small matrix") {
  // Two oscillators of 3 rad/s on one ground; k of one of them moves: slopes 0 and j omega / 2k.
  Diagram d{"twins"};
  const Param k = d.param("k", 18);
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 2, .stiffness = k});
  auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 18});
  ground(a), ground(b);
  a.child.force = u, b.child.force = u;
  d.output("x") = a.stretch + b.stretch;
  const auto poles = derivatives(compile(d), {"k"}).poles();
  REQUIRE(poles.size() == 1);
  CHECK(poles[0].count == 2);
  CHECK(std::abs(poles[0].s - std::complex<double>(0, 3)) <= 1e-14);
  Eigen::VectorXcd slopes = poles[0].slopes[0];
  if (std::abs(slopes(0)) > std::abs(slopes(1))) std::swap(slopes(0), slopes(1));
  CHECK(std::abs(slopes(0)) <= 1e-14);
  CHECK(std::abs(slopes(1) - std::complex<double>(0, 3.0 / (2 * 18))) <= 1e-14);
}

TEST_CASE("parameters without a derivative are refused or marked") {
  Diagram d{"free"};
  auto z = d.add("z", SpringMass{.mass = d.param("m", 2), .stiffness = 4, .parent_mass = 1});
  z.parent.force = -d.input("u");
  d.output("x") = z.position;
  const Derivatives g = derivatives(compile(d), {"m"});
  const auto poles = g.poles();
  REQUIRE(poles.size() == 2);
  CHECK(poles[0].defective);  // the double integrator of the free position
  CHECK(poles[0].slopes.empty());
  // (1 + m) 4 / m: omega^2 of the free pair
  const double m = 2, omega = std::sqrt(4 * (1 + m) / m);
  CHECK(std::abs(poles[1].slopes[0](0) - std::complex<double>(0, -4 / (m * m) / (2 * omega))) <=
        1e-12);
  CHECK(error_of([&] { g.h2(); }).has(Code::singular));
  CHECK(titop_test::says(error_of([&] { g.transfer(1, "k"); }), Code::unknown_name, {"k", "m"}));
  CHECK(titop_test::says(error_of([&] {
                           derivatives(compile(d), {"m", "q", "m"});
                         }),
                         Code::unknown_name, {"q", "m"}));
  CHECK(error_of([&] { derivatives(compile(d), {"m", "m"}); }).has(Code::duplicate_name));
}

TEST_CASE("an H2 norm of 0 has no derivatives") {
  Diagram d{"apart"};
  auto pushed = d.add("pushed", SpringMass{.mass = 1, .stiffness = 2, .damping = 0.1});
  auto seen = d.add("seen", SpringMass{.mass = 1, .stiffness = d.param("k", 3), .damping = 0.1});
  ground(pushed), ground(seen);
  pushed.child.force += d.input("u");
  d.output("x") = seen.stretch;
  const Derivatives g = derivatives(compile(d), {"k"});
  CHECK(titop_test::says(error_of([&] { g.h2(); }), Code::singular, {"0"}));
}

namespace {

/// The H2 norm of (b3 s^3 + ... + b0) / (a4 s^4 + ... + a0) [Newton, Gould, Kaiser 1957, app. E].
long double h2_of_fourth_order(const std::array<long double, 4>& b,
                               const std::array<long double, 5>& a) {
  const long double up = b[3] * b[3] * (a[0] * a[1] * a[2] - a[0] * a[0] * a[3]) +
                         (b[2] * b[2] - 2 * b[1] * b[3]) * a[0] * a[1] * a[4] +
                         (b[1] * b[1] - 2 * b[0] * b[2]) * a[0] * a[3] * a[4] +
                         b[0] * b[0] * (a[2] * a[3] * a[4] - a[1] * a[4] * a[4]);
  const long double down =
      2 * a[0] * a[4] * (a[1] * a[2] * a[3] - a[0] * a[3] * a[3] - a[1] * a[1] * a[4]);
  return std::sqrt(up / down);
}

}  // namespace

TEST_CASE("the H2 norm of a slow mode beside a fast one") {
  // A heavy mass on a soft spring (0.01 rad/s) carries a light one on a stiff spring.
  for (const double fast : {1e2, 1e4, 1e6, 3e6}) {
    CAPTURE(fast);
    const double M = 1000, k = 0.1, c = 0.02, m = 1, kf = m * fast * fast, cf = 0.004 * m * fast;
    Diagram d{"graded"};
    auto heavy = d.add("heavy", SpringMass{.mass = M, .stiffness = d.param("k", k), .damping = c});
    auto light = d.add("light", SpringMass{.mass = m, .stiffness = kf, .damping = cf});
    ground(heavy);
    mount(light, heavy.child);
    heavy.child.force += d.input("u");
    d.output("x") = heavy.stretch;
    const auto norm = [&](long double k0) {
      return h2_of_fourth_order(
          {kf, cf, m, 0},
          {k0 * kf, c * static_cast<long double>(kf) + cf * k0,
           static_cast<long double>(M) * kf + m * (k0 + kf) + static_cast<long double>(c) * cf,
           static_cast<long double>(M) * cf + m * (static_cast<long double>(c) + cf),
           static_cast<long double>(M) * m});
    };
    const Slopes n = derivatives(compile(d), {"k"}).h2();
    CHECK(std::abs(n.value / static_cast<double>(norm(k)) - 1) <= 1e-11 * std::max(1.0, fast));
    const auto slope = static_cast<double>((norm(1.001L * k) - norm(0.999L * k)) / (0.002L * k));
    CHECK(std::abs(n.slopes(0) / slope - 1) <= 1e-5);
  }
}

TEST_CASE("an undamped structure has no H2 norm, whatever rounding makes of its poles") {
  titop_test::Rng rng(5);
  const auto draw = [&] { return rng.between(0.5, 4.5); };
  for (int i = 0; i < 100; ++i) {
    CAPTURE(i);
    Diagram d{"undamped"};
    auto a = d.add("a", SpringMass{.mass = draw(), .stiffness = d.param("k", 10 * draw())});
    auto b = d.add("b", SpringMass{.mass = draw(), .stiffness = 10 * draw()});
    ground(a);
    mount(b, a.child);
    b.child.force += d.input("u");
    d.output("x") = a.stretch;
    CHECK(error_of([&] { derivatives(compile(d), {"k"}).h2(); }).has(Code::singular));
  }
}

TEST_CASE("two equal real poles that rounding splits are one pole with two slopes") {
  // A = T diag(-5, -5, -1) T^-1, of which the entry A11 moves: the slopes of the pair are 0 and the
  // entry 11 of its projector.
  titop_test::Rng rng(3);
  for (int i = 0; i < 100; ++i) {
    CAPTURE(i);
    const Eigen::Matrix3d T = 2 * Eigen::Matrix3d::Identity() + rng.matrix(3, 3);
    const Eigen::Matrix3d inverse = T.inverse();
    const Eigen::MatrixXd A = T * Eigen::Vector3d(-5, -5, -1).asDiagonal() * inverse;
    Diagram d{"pair"};
    auto K = d.add("K", Lti{.A = A,
                            .B = Eigen::Vector3d(1, 2, 3),
                            .C = Eigen::RowVector3d(1, 1, 1),
                            .values = {{'A', 1, 1, d.param("p", A(0, 0))}}});
    K.in = d.input("u");
    d.output("y") = K.out;
    const auto poles = derivatives(compile(d), {"p"}).poles();
    REQUIRE(poles.size() == 2);
    CHECK(poles[1].count == 2);
    CHECK(poles[1].s.imag() == 0);
    CHECK(std::abs(poles[1].s + 5.0) <= 1e-12);
    REQUIRE(!poles[1].defective);
    const Eigen::VectorXcd slopes = poles[1].slopes[0];
    const double all = T.row(0).head<2>() * inverse.col(0).head<2>();
    CHECK(std::abs(slopes.sum() - all) <= 1e-11);
    CHECK(slopes.cwiseAbs().minCoeff() <= 1e-11);
  }
}

TEST_CASE("a derivative at s = 0, where a hinge alone has a pole") {
  // J thetadd = u - k theta - c thetad: 1 / k at 0, the largest gain as c^2 > 2 k J.
  Diagram d{"pendulum"};
  auto base = d.add("base", RigidBody{.children = {{"C", {0, 0, 0}}}});
  auto arm = d.add("arm", RigidBody{.mass = 1, .inertia = {2, 2, 1, 0, 0, 0}});
  ground(base);
  auto h = hinge(d, "hinge", arm, base.child, {}, {0, 0, 1});
  h.torque = d.param("k", 4) * h.angle + 5 * h.rate - d.input("u");
  d.output("angle") = h.angle;
  const Derivatives g = derivatives(compile(d), {"k"});
  CHECK(std::abs(g.transfer(0, "k")(0, 0) + 1.0 / 16) <= 1e-15);
  CHECK(std::abs(g.transfer(0, "k", "k")(0, 0) - 2.0 / 64) <= 1e-15);
  CHECK(std::abs(g.transfers(0)[0](0, 0) + 1.0 / 16) <= 1e-15);
  const PeakSlopes peak = g.peak();
  CHECK(peak.omega == 0);
  CHECK(std::abs(peak.value - 0.25) <= 1e-15);
  CHECK(std::abs(peak.slopes(0) + 1.0 / 16) <= 1e-15);
}
