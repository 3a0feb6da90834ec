#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/close.hpp"

/// Names are for people: two names of the same appearance are still two names.

using namespace titop;
using titop_test::matrix_error;

namespace {

/// A wing on an arm by a hinge of this name, both free; positions of both.
Diagram arm_and_wing(const std::string& hinge_name, const std::string& extra) {
  Diagram d{"arm and wing"};
  auto arm = d.add("arm", RigidBody{.mass = 2, .children = {{"C", {1, 0, 0}}}});
  auto wing = d.add("wing", RigidBody{.mass = 1, .children = {{"F", {1, 0, 0}}}});
  arm.parent.force = -d.input("U", 6);
  hinge(d, hinge_name, wing, arm.child("C"), {}, {0, 1, 0}).torque = 0;
  auto i = d.add(extra, Integrator{});
  i.in = arm.parent.along({1, 0, 0}).accel;
  d.output("x", 6) = arm.parent.position;
  d.output("tip", 6) = wing.child("F").position;
  d.output("speed") = i.out;
  return d;
}

}  // namespace

TEST_CASE("a hinge, a node: none is taken for a body's point of the same printed name") {
  const std::complex<double> s{0.3, 1.1};
  const System plain = compile(arm_and_wing("h", "i"));
  const auto right = plain.transfer(s);
  CHECK(right.topRows(6).cwiseAbs().maxCoeff() > 0.1);
  for (const char* hinge : {"arm.parent", "wing.F", "h"})
    for (const char* extra : {"i", "arm.parent.linear_rate", "arm.parent.angular_position"}) {
      CAPTURE(hinge);
      CAPTURE(extra);
      const System other = compile(arm_and_wing(hinge, extra));
      CHECK(matrix_error(other.transfer(s), right) <= 1e-13);
      CHECK(other.order() == plain.order());
      CHECK(certify(other).holds());
    }
}
