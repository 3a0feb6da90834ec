#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "support/notes.hpp"

/// Outputs that are sums of cancelling states: a zero rotation has lost no digits.

using namespace titop;
using Eigen::Matrix3d, Eigen::Vector3d;

namespace {

/// A crank and a rocker of one length, pins 1 apart, and the coupler between their tips. The rocker
/// leans by `off` more than the crank: as much, about, the coupler turns where the crank turns
/// by 1. A disk is sprung on the middle of the coupler.
Diagram swing(double angle, double off) {
  Diagram d{"swing"};
  const double length = 0.7;
  const auto end = [&](double a) {
    return Vector3d(length * std::cos(a), length * std::sin(a), 0);
  };
  const auto link = [](double along) {
    return RigidBody{.mass = 2,
                     .inertia = 0.2 * Matrix3d::Identity(),
                     .PA = {along / 2, 0, 0},
                     .children = {{"C", {along, 0, 0}}, {"middle", {along / 2, 0, 0}}}};
  };
  const Vector3d z{0, 0, 1}, foot = Vector3d(1, 0, 0) + end(angle) - end(angle + off);
  auto base = d.add("base", RigidBody{.children = {{"J1"}, {"J2", foot}}});
  auto crank = d.add("crank", link(length)), coupler = d.add("coupler", link(1)),
       rocker = d.add("rocker", link(length));
  auto disk = d.add("disk", RigidBody{.mass = 1, .inertia = 0.1 * Matrix3d::Identity()});
  ground(base);
  auto p1 = hinge(d, "p1", crank, base.child("J1"), Rotation::about(z, angle), z);
  p1.torque = 30.0 * p1.angle;
  hinge(d, "p2", coupler, crank.child("C"), Rotation::about(z, -angle), z).torque = 0;
  hinge(d, "p3", rocker, base.child("J2"), Rotation::about(z, angle + off), z).torque = 0;
  auto p4 = d.add("p4", Hinge{z});
  mount(p4, rocker.child("C"), Rotation::about(z, -angle - off));
  weld(coupler.child("C"), p4.child);
  p4.torque = 0;
  auto spring = hinge(d, "spring", disk, coupler.child("middle"), {}, z);
  spring.torque = 5.0 * spring.angle;
  coupler.child("C").force += d.input("F", 6);
  d.output("place", 6) = coupler.child("C").position;
  d.output("disk") = spring.angle;
  return d;
}

}  // namespace

TEST_CASE("a coupler that does not turn by symmetry has lost no digits, one that nearly does has") {
  for (const double angle : {0.7, 0.9, 1.1, std::numbers::pi / 2})
    for (const double off : {0.0, 1e-11, 0.2}) {
      CAPTURE(angle);
      CAPTURE(off);
      CHECK(titop_test::outputs_lose_digits(compile(swing(angle, off))) == (off == 1e-11));
    }
}

TEST_CASE("and none of how far it moves") {
  const System system = compile(swing(0.9, 0));
  const std::complex<double> s(0, 2);
  const Eigen::MatrixXcd G = system.state_space().transfer(s);
  // The crank's angle q: two links turn about their pins, the coupler and the disk go with the tip.
  const double inertia = 2 * (0.2 + 2 * 0.35 * 0.35) + (2 + 1) * 0.7 * 0.7;
  const Vector3d way(-0.7 * std::sin(0.9), 0.7 * std::cos(0.9), 0);
  const Eigen::Matrix3cd exact =
      (way * way.transpose()).cast<std::complex<double>>() / (inertia * s * s + 30.0);
  CHECK((G.topLeftCorner(3, 3) - exact).cwiseAbs().maxCoeff() <=
        1e-12 * exact.cwiseAbs().maxCoeff());
}
