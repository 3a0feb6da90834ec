#include <doctest/doctest.h>

#include <array>

#include "assembly.hpp"
#include "support/mistakes.hpp"

/// Over-constrained chains with very different masses: rounding in the sum of forces of the heavy
/// mass is no internal force that moves it.

using namespace loops_test;
using namespace titop;

namespace {

constexpr double kSpring = 30;  ///< of the crank's pin [N m/rad]

/// Crank, coupler and rocker, pins about z of the world where these points are; each link's frame
/// is turned. Link i weighs mass[i].
struct FourBar {
  std::array<double, 3> mass = {2, 2, 2};
  std::array<Vector3d, 4> pin = {Vector3d(0, 0, 0), Vector3d(0.3, 0.8, 0.1),
                                 Vector3d(1.1, 0.9, -0.2), Vector3d(1, 0, 0.3)};
  std::array<Matrix3d, 3> frame = {Matrix3d::Identity(), Matrix3d::Identity(),
                                   Matrix3d::Identity()};
  std::size_t pushed = 0;  ///< link

  double inertia(std::size_t i) const { return mass[i] / 12; }  ///< about every axis
  /// Point of force on a link, in its frame.
  static Vector3d push() { return {0.3, 0.2, 0.1}; }
};

Diagram diagram(const FourBar& f) {
  Diagram d{"four-bar"};
  const Vector3d z{0, 0, 1};
  auto base = d.add("base", RigidBody{.children = {{"first", f.pin[0]}, {"last", f.pin[3]}}});
  ground(base);
  std::vector<BodyHandle> link;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d along = f.frame[i].transpose() * (f.pin[i + 1] - f.pin[i]);
    link.push_back(d.add("link" + std::to_string(i),
                         RigidBody{.mass = f.mass[i],
                                   .inertia = f.inertia(i) * Matrix3d::Identity(),
                                   .PA = along / 2,
                                   .children = {{"end", along}, {"push", FourBar::push()}}}));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Matrix3d T = i == 0 ? f.frame[0] : Matrix3d(f.frame[i - 1].transpose() * f.frame[i]);
    auto h = hinge(d, "pin" + std::to_string(i), link[i],
                   i == 0 ? base.child("first") : link[i - 1].child("end"), Rotation::matrix(T),
                   f.frame[i].transpose() * z);
    if (i == 0)
      h.torque = kSpring * h.angle, d.output("turn") = h.angle;
    else
      h.torque = 0;
  }
  auto last = d.add("pin3", Hinge{z});
  mount(last, base.child("last"));
  weld(link[2].child("end"), last.child, Rotation::matrix(f.frame[2]));
  last.torque = 0;
  link[f.pushed].child("push").force += d.input("F", 6);
  return d;
}

/// From the wrench to the crank's angle q, by the energy of all links per square of its rate.
MatrixXcd by_hand_at(const FourBar& f, Complex s) {
  const auto turned = [](const Vector3d& r) { return Vector3d(-r(1), r(0), 0); };
  const auto link = [&](std::size_t i) { return Vector3d(f.pin[i + 1] - f.pin[i]); };
  // Rates of coupler and rocker: the last pin stays.
  Eigen::Matrix2d M;
  M << turned(link(1)).head<2>(), turned(link(2)).head<2>();
  const Eigen::Vector2d others = M.inverse() * -turned(link(0)).head<2>();
  const std::array<double, 3> rate = {1, others(0), others(1)};
  double energy = 0;
  Vector3d at_pin = Vector3d::Zero();
  Eigen::Matrix<double, 1, 6> moved;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d middle = at_pin + rate[i] * turned(link(i) / 2);
    energy += f.mass[i] * middle.squaredNorm() + f.inertia(i) * rate[i] * rate[i];
    const Matrix3d into = f.frame[i].transpose();
    if (i == f.pushed)
      moved << (into * (at_pin + rate[i] * turned(f.frame[i] * FourBar::push()))).transpose(),
          rate[i] * into.col(2).transpose();
    at_pin += rate[i] * turned(link(i));
  }
  return moved.cast<Complex>() / (energy * s * s + kSpring);
}

/// Bodies welded twice, which share a wrench; half of it moves `third`.
Diagram driven(double mass_of_third) {
  const auto block = [](double mass, const Vector3d& far) {
    return RigidBody{.mass = mass,
                     .inertia = mass * Vector3d(0.2, 0.3, 0.4).asDiagonal(),
                     .PA = far / 3,
                     .children = {{"near", far / 2}, {"far", far}}};
  };
  Diagram d{"driven"};
  auto A = d.add("A", block(4, {1, 0.5, 0.2})), B = d.add("B", block(3, {0.5, 0.25, 0.1}));
  auto third = d.add("third", block(mass_of_third, {1, 0, 0}));
  A.parent.force = -d.input("U", 6);
  mount(B, A.child("near"));
  weld(B.child("far"), A.child("far"));
  third.parent.force = MatrixXd(0.5 * MatrixXd::Identity(6, 6)) * B.parent.force;
  d.output("c", 6) = third.parent.accel;
  return d;
}

}  // namespace

TEST_CASE("a four-bar with one link a thousand million times as heavy, or more, is no mistake") {
  for (const double ratio : {1.0, 1e6, 1e9, 1e12})
    for (std::size_t heavy = 0; heavy < 3; ++heavy)
      for (const double angle : {0.0, 0.7, -1.9}) {
        CAPTURE(ratio);
        CAPTURE(heavy);
        CAPTURE(angle);
        FourBar f{.pushed = heavy == 0 ? std::size_t{1} : std::size_t{0}};
        f.mass[heavy] *= ratio;
        for (std::size_t i = 0; i < 3; ++i)
          f.frame[i] = Eigen::AngleAxisd(angle * static_cast<double>(i + 1),
                                         Vector3d(1, 2, -2 + static_cast<double>(i)).normalized())
                           .toRotationMatrix();
        const System system = compile(diagram(f));
        CHECK(system.order() == 2);
        const Complex s = Complex(0.3, 3) / std::sqrt(ratio);
        const MatrixXcd exact = by_hand_at(f, s);
        CHECK((system.transfer(s) - exact).cwiseAbs().maxCoeff() <=
              1e-13 * exact.cwiseAbs().maxCoeff());
      }
}

TEST_CASE("an internal force that moves a body is refused, however heavy the body is") {
  for (const double mass : {2e-9, 2.0, 2e9, 2e12}) {
    CAPTURE(mass);
    CHECK(titop_test::says(titop_test::compile_error(driven(mass)), Code::kinematic_loop,
                           {"third", "InternalForces::minimal_norm"}));
  }
}
