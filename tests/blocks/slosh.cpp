#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

/// A sloshing mode at an offset, across an oblique axis, against M, D and K by hand.

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using titop_test::error_of;

namespace {

const Vector3d kAxis = Vector3d(1, 2, 2) / 3, kAt(0.3, -0.2, 0.5);
constexpr double kHub = 40, kMass = 7, kStiffness = 3, kDamping = 0.2;

Diagram scene(const Slosh& spec) {
  Diagram d{"tank"};
  auto hub = d.add("hub", RigidBody{.mass = kHub,
                                    .inertia = Vector3d(5, 6, 7).asDiagonal(),
                                    .children = {{"tank", kAt}}});
  hub.parent.force = -d.input("U", 6);
  const auto fuel = slosh(d, "fuel", hub.child("tank"), spec);
  d.output("accel", 6) = hub.parent.accel;
  d.output("b") = fuel.axis("b").position;
  d.output("c") = fuel.axis("c").position;
  return d;
}

/// Coordinates: hub, then the liquid against the tank along b and c.
MatrixXcd by_hand(double mass, std::complex<double> s) {
  const Vector3d b = Vector3d(1, 0, 0) - kAxis.x() * kAxis, unit = b.normalized(),
                 c = kAxis.cross(unit);
  MatrixXd M = MatrixXd::Zero(8, 8), liquid = MatrixXd::Zero(3, 8);
  M.diagonal() << kHub, kHub, kHub, 5, 6, 7, 0, 0;
  Eigen::Matrix3d arm;  // kAt x
  arm << 0, -kAt.z(), kAt.y(), kAt.z(), 0, -kAt.x(), -kAt.y(), kAt.x(), 0;
  liquid.leftCols(3).setIdentity();
  liquid.middleCols(3, 3) = -arm;
  liquid.col(6) = unit, liquid.col(7) = c;
  M += mass * liquid.transpose() * liquid;
  MatrixXcd L = (s * s * M).eval();
  for (int i = 6; i < 8; ++i) L(i, i) += kDamping * s + kStiffness;
  MatrixXcd B = MatrixXcd::Zero(8, 6);
  B.topRows(6).setIdentity();
  MatrixXcd x = L.partialPivLu().solve(B);
  x.topRows(6) *= s * s;
  return x;
}

}  // namespace

TEST_CASE("slosh: hub and liquid against M, D, K by hand") {
  Diagram d =
      scene({.mass = kMass, .stiffness = kStiffness, .damping = kDamping, .axis = 5 * kAxis});
  const System system = compile(d);
  CHECK(system.state_space().order() == 4);
  for (const std::complex<double> s : {std::complex(0.1, 0.5), {0.0, 2.0}, {1.0, 30.0}}) {
    MatrixXcd right = by_hand(kMass, s), H = system.transfer(s);
    CHECK((H.topRows(6) - right.topRows(6)).norm() <= 1e-13 * right.norm());
    // b and c may be any two vectors across the axis: their lengths together are not.
    CHECK(std::abs(H.bottomRows(2).norm() / right.bottomRows(2).norm() - 1) <= 1e-13);
  }
}

TEST_CASE("slosh: an axis without direction and a negative mass are refused") {
  CHECK(error_of([] {
          scene({.mass = 1, .stiffness = 1, .axis = {0, 0, 0}});
        }).has(Code::bad_value));
  CHECK(error_of([] { scene({.mass = -1, .stiffness = 1}); }).has(Code::bad_inertia));
}
