#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <titop/titop.hpp>

#include "oracle.hpp"

/// Entries of the transfer that are tiny compared with their cancelling terms, and others that are
/// 0 by symmetry: in double both are rounding. Finer arithmetic distinguishes them.

using namespace titop;
using solve_test::Complex;

namespace {

struct Springs {
  std::array<double, 3> m, k;
  double omega;
};

/// Three masses in a row from a wall, pushed at the end.
Diagram diagram(const Springs& row) {
  Diagram d{"row"};
  std::vector<SpringMass::Handle> z;
  for (std::size_t i = 0; i < 3; ++i) {
    z.push_back(
        d.add("z" + std::to_string(i), SpringMass{.mass = row.m[i], .stiffness = row.k[i]}));
    if (i == 0)
      ground(z[0].parent);
    else
      mount(z[i], z[i - 1].child);
    d.output("s" + std::to_string(i)) = z[i].stretch;
  }
  z[2].child.force += d.input("u");
  return d;
}

/// The stretches, from the wall outwards, for a unit displacement of the first mass.
std::array<Complex, 3> stretches(const Springs& row, std::complex<double> at) {
  const Complex s(at), s2 = s * s;
  std::array<Complex, 3> stretch;
  Complex x(0.0), force;  // of the spring inwards, and so of the first one
  stretch[0] = Complex(1.0);
  force = Complex(row.k[0]);
  for (std::size_t i = 0;; ++i) {
    x = x + stretch[i];
    force = force + Complex(row.m[i]) * s2 * x;
    if (i == 2) break;
    stretch[i + 1] = force / Complex(row.k[i + 1]);
  }
  for (Complex& e : stretch) e = e / force;
  return stretch;
}

double off(std::complex<double> found, const Complex& exact) {
  const Complex error = (Complex(found) - exact) / exact;
  return static_cast<double>(sqrt(error.squared()));
}

}  // namespace

TEST_CASE("small entries: an entry at rounding level in double is right, or refused") {
  const Springs rows[] = {{{1e-10, 1e9, 100}, {1e-4, 1e10, 10}, 10},
                          {{0.01, 1e11, 1e-9}, {1e-12, 1e7, 1e-7}, 0.01},
                          {{1e-9, 1000, 0.1}, {1e-9, 1e10, 0.1}, 1},
                          {{1e-11, 1e7, 1e11}, {1e-8, 1e10, 1e-4}, 100},
                          {{1, 2, 3}, {4, 5, 6}, 1}};
  for (const Springs& row : rows) {
    const System system = compile(diagram(row), {.minimize_up_to = 0});
    const std::complex<double> s(0.1 * row.omega, row.omega);
    const std::array<Complex, 3> exact = stretches(row, s);
    for (const Precision p : {Precision::as_needed, Precision::refined, Precision::twofold}) {
      CAPTURE(row.omega);
      CAPTURE(static_cast<int>(p));
      try {
        const Eigen::MatrixXcd G = system.transfer(s, p);
        for (int i = 0; i < 3; ++i)
          CHECK(off(G(i, 0), exact[static_cast<std::size_t>(i)]) <= 1e-11);
      } catch (const Error& error) {
        CHECK(error.has(Code::singular));
        CHECK(p != Precision::as_needed);
      }
    }
  }
}

TEST_CASE(
    "small entries: zeros by symmetry need no finer arithmetic, and no precision refuses them") {
  // A force at the center of mass does not rotate a body, in any frame.
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Diagram d{"body"};
  const auto at = [&](double x, double y, double z) -> Eigen::Vector3d {
    return R * Eigen::Vector3d(x, y, z);
  };
  auto left = d.add("left", RigidBody{.mass = 2, .inertia = {1, 1, 1}});
  auto body = d.add("body", RigidBody{.mass = 3,
                                      .inertia = {2, 2, 2},
                                      .children = {{"l", at(1, 0.3, 0)}, {"r", at(-1, -0.3, 0)}}});
  auto right = d.add("right", RigidBody{.mass = 2, .inertia = {1, 1, 1}});
  mount(left, body.child("l"));
  mount(right, body.child("r"));
  body.parent.force = -d.input("U", 6);
  d.output("a", 6) = body.parent.accel;
  const System system = compile(d);
  for (const Precision p : {Precision::as_needed, Precision::refined, Precision::twofold}) {
    const Eigen::MatrixXcd G = system.transfer({0.1, 1}, p);
    CHECK(G.block(3, 0, 3, 3).cwiseAbs().maxCoeff() <= 1e-15);
    CHECK(std::abs(G(0, 0) - 1.0 / 7) <= 1e-15);
  }
}
