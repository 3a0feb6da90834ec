#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

/// Near a singular posture the angles of a closed chain have few digits: the error says so.

using namespace titop;

namespace {

constexpr double kStiffness = 5, kCrank = 0.3;
/// Crank and rocker turn about their pins, the coupler translates on a circle.
const double kInertia = 2 * (0.1 + 2 * 0.15 * 0.15) + 3 * kCrank * kCrank;

/// A parallelogram in the plane z = 0, turned by `angle` out of its folded posture; a spring and a
/// torque on the crank.
Diagram parallelogram(double angle) {
  Diagram d{"parallelogram"};
  const Vector3d z(0, 0, 1);
  auto base = d.add("base", RigidBody{.children = {{"A"}, {"D", {1, 0, 0}}}});
  ground(base);
  const auto link = [&](const char* name, double length, double mass) {
    return d.add(name, RigidBody{.mass = mass,
                                 .inertia = {0.1, 0.1, 0.1},
                                 .PA = {length / 2, 0, 0},
                                 .children = {{"C", {length, 0, 0}}}});
  };
  auto crank = link("crank", kCrank, 2), coupler = link("coupler", 1, 3),
       rocker = link("rocker", kCrank, 2);
  auto a = hinge(d, "a", crank, base.child("A"), Rotation::about(z, angle), z);
  a.torque = kStiffness * a.angle - d.input("u");
  hinge(d, "b", coupler, crank.child, Rotation::about(z, -angle), z).torque = 0;
  auto c = hinge(d, "c", rocker, base.child("D"), Rotation::about(z, angle), z);
  c.torque = 0;
  auto end = d.add("end", Hinge{z});
  mount(end, rocker.child, Rotation::about(z, -angle));
  weld(coupler.child, end.child);
  end.torque = 0;
  d.output("crank") = a.angle;
  d.output("rocker") = c.angle;
  return d;
}

}  // namespace

TEST_CASE("a parallelogram near its folded posture: the error covers that of both angles") {
  const double omega = std::sqrt(kStiffness / kInertia);
  for (const double angle : {1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 3.7e-6, 1e-6, 1e-7, 3.7e-8, 1e-8}) {
    CAPTURE(angle);
    const Trajectory t =
        simulate(compile(parallelogram(angle)), Excitation::step(Eigen::VectorXd::Constant(1, 1.0)),
                 {.step = 0.01, .until = 2});
    Eigen::Vector2d off = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < t.time.size(); ++k) {
      const double turn = (1 - std::cos(omega * t.time[k])) / kStiffness;
      off = off.cwiseMax(
          (t.y.col(static_cast<Eigen::Index>(k)).array() - turn).abs().matrix().eval());
    }
    off *= kStiffness / 2;  // the largest turn is 2 / stiffness
    for (const Eigen::Index i : {0, 1}) {
      CAPTURE(i);
      CHECK(off(i) <= t.error(i) + 1e-13);
      CHECK(t.error(i) <= 1e-13 / angle);  // and claims no more than some hundred roundings
    }
  }
}
