#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"

/// Mounting on a parent point, whose force has the other sign: the wrench still comes back.

using namespace titop;

TEST_CASE("mount: a spring-mass on the free parent point of another") {
  Diagram d{"back to back"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 3, .stiffness = 70, .damping = 0.4, .parent_mass = 2});
  auto z2 = d.add("z2", SpringMass{.mass = 5, .stiffness = 40, .damping = 0.2, .parent_mass = 1});
  z1.parent.force = 0;
  mount(z2, z1.parent);
  z2.child.force = u;
  d.output("a1") = z1.child.accel;
  d.output("a2") = z2.child.accel;
  const System system = compile(d);
  // By hand: m1 on a spring at P, m2 on another, P weighs 2 + 1; [x1; x2; xP] by a force on m2.
  for (const std::complex<double> s : {std::complex<double>{0.3, 2}, {1, 9}}) {
    const std::complex<double> k1 = 70.0 + 0.4 * s, k2 = 40.0 + 0.2 * s;
    Eigen::Matrix3cd Z;
    Z << 3.0 * s * s + k1, 0, -k1,  //
        0, 5.0 * s * s + k2, -k2,   //
        -k1, -k2, 3.0 * s * s + k1 + k2;
    const Eigen::Vector3cd x = Z.partialPivLu().solve(Eigen::Vector3cd(0, 1, 0));
    CHECK(titop_test::matrix_error(system.transfer(s), s * s * x.head<2>()) <= 1e-14);
  }
}
