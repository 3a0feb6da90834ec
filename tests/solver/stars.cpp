#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/titop.hpp>

#include "support/close.hpp"

/// A hub with very many appendages, and sums of very many terms: rows over all of them become
/// partial sums, and the work stays linear in their number.

using namespace titop;
using titop_test::matrix_error;

namespace {

Diagram star(int n) {
  Diagram d{"star"};
  RigidBody hub{.mass = 100, .inertia = 40 * Eigen::Matrix3d::Identity()};
  for (int i = 0; i < n; ++i)
    hub.children.push_back({fmt::format("C{}", i + 1), {std::cos(i), std::sin(i), 0.1 * i}});
  const FlexibleBody wing = Beam{.length = 2.0,
                                 .section = rectangle(0.06, 0.04),
                                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                 .elements = 2,
                                 .modes = {.kept = 3, .xi = {0.005}}};
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  B.parent.force = -U;
  const Eigen::MatrixXd sensor{{0.5, 0, 0, 0, 0.2, 0}};
  Expr sum;
  for (int i = 0; i < n; ++i) {
    auto A = d.add(fmt::format("A{}", i + 1), wing);
    mount(A, B.child(fmt::format("C{}", i + 1)), Rotation::about({0, 0, 1}, 0.1 * i));
    const Expr one = sensor * A.child.accel;
    sum = i == 0 ? one : sum + one;
  }
  d.output("hub", 6) = B.parent.accel;
  d.output("sum") = sum;
  return d;
}

/// Of the elimination.
int fronts(int n) { return compile(star(n), {.minimize_up_to = 0}).certificate().fronts; }

}  // namespace

TEST_CASE("star: the same transfer as all equations solved together") {
  for (const int n : {3, 14, 40}) {
    const Diagram d = star(n);
    const System system = compile(d, {.minimize_up_to = 0});
    CAPTURE(n);
    CHECK(system.certificate().residual <= 1e-12);
    const std::complex<double> s{0.7, 9};
    CHECK(matrix_error(system.transfer(s), transfer(d.graph(), s)) <= 1e-11);
    StateSpace m;
    system.write(m);
    CHECK(matrix_error(m.transfer(s), system.transfer(s)) <= 1e-10);
  }
}

TEST_CASE("star: fronts and entries grow linearly") {
  const auto entries = [](int n) {
    return compile(star(n), {.minimize_up_to = 0}).descriptor().A.nonZeros();
  };
  const auto a = entries(40), b = entries(80), c = entries(160);
  CHECK(double(c - b) <= 2.2 * double(b - a));
  CHECK(fronts(160) <= 5 * fronts(40));
}
