// The block of a rotor: parameters, mistakes, its motor, imbalance.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;

namespace {

const Vector3d z(0, 0, 1);

}  // namespace

TEST_CASE("a motor turns the rotor against its carrier, and the sum of momenta stays") {
  // About z: I_h w' = -(tau - c nu), I_a (w' + nu') = tau - c nu.
  const double axial = 0.05, I_h = 6, c = 0.2;
  Diagram d{"wheel"};
  auto hub = d.add(
      "hub",
      RigidBody{.mass = 50, .inertia = Vector3d(5, 5, I_h).asDiagonal(), .children = {{"C"}}});
  auto wheel = d.add("wheel", Rotor{.mass = 0, .axial = axial, .transverse = 0.03});
  mount(wheel, hub.child);
  release(hub);
  wheel.torque = c * wheel.speed - d.input("motor");
  d.output("speed") = wheel.speed;
  d.output("rate") = hub.parent.rate.angular().along(z);
  const System system = compile(d);
  const std::complex<double> s(0.3, 0.8);
  const double turned = 1 / axial + 1 / I_h;
  const std::complex<double> speed = turned / (s + c * turned),
                             rate = -(1.0 - c * speed) / (I_h * s);
  const Eigen::MatrixXcd H = system.transfer(s);
  CHECK(std::abs(H(0, 0) - speed) <= 1e-12 * std::abs(speed));
  CHECK(std::abs(H(1, 0) - rate) <= 1e-12 * std::abs(rate));
  CHECK(system.state_space().order() == 1);  // I_h w + I_a (w + nu) = 0
}

TEST_CASE("rotors: parameters with the least occurrences, and mistakes with the way out") {
  Diagram d{"parameters"};
  const Param m = d.param("m", 6), I_a = d.param("I_a", 0.05), I_t = d.param("I_t", 0.03),
              h = d.param("h", 20);
  auto hub = d.add("hub", RigidBody{.mass = 1000,
                                    .inertia = Vector3d(4, 5, 6).asDiagonal(),
                                    .children = {{"B", {0.3, -0.2, 0.5}}}});
  auto wheel = d.add(
      "wheel", Rotor{.mass = m, .axial = I_a, .transverse = I_t, .axis = {0, 3, 4}, .momentum = h});
  mount(wheel, hub.child("B"));
  wheel.torque = -d.input("motor");
  hub.parent.force = -d.input("U", 6);
  d.output("accel", 6) = hub.parent.accel;
  d.output("speed") = wheel.speed;
  const System system = compile(d);
  const Lft f = lft(
      system,
      {{"m", percent(20)}, {"I_a", percent(10)}, {"I_t", percent(10)}, {"h", between(-30, 40)}});
  const std::map<std::string, double> at = {{"m", 5.5}, {"I_a", 0.052}, {"I_t", 0.031}, {"h", -11}};
  const System updated = system.update({at.begin(), at.end()});
  const std::complex<double> s(0.4, 1.3);
  const Eigen::MatrixXcd right = updated.transfer(s);
  CHECK((f.at({at.begin(), at.end()}).transfer(s) - right).norm() <= 1e-11 * right.norm());
  const int expected[] = {3, 1, 2, 2};
  for (std::size_t i = 0; i < 4; ++i) CHECK(f.deltas()[i].size == expected[i]);

  const auto refused = [](const Rotor& rotor) {
    return error_of([&] { Diagram{"wrong"}.add("w", rotor); });
  };
  CHECK(says(refused({.axial = 0.07, .transverse = 0.03}), Code::bad_inertia, {"w", "0.07"}));
  CHECK(says(refused({.mass = -1}), Code::bad_inertia, {"w", "-1"}));
  CHECK(says(refused({.axis = {0, 0, 0}}), Code::bad_value, {"w"}));
  CHECK(says(refused({.momentum = NAN}), Code::not_finite, {"w"}));
  CHECK(says(error_of([] {
               Diagram e{"undriven"};
               auto w = e.add("w", Rotor{});
               ground(w);
               e.output("speed") = w.speed;
               compile(e);
             }),
             Code::no_equation, {"w.torque"}));
}

TEST_CASE("imbalance: force and torque that turn with the rotor") {
  const double speed = 30, across = 7e-3, product = 2e-3;
  Diagram d{"imbalance"};
  auto wheel = d.add("wheel", Rotor{.mass = 6, .axial = 0.05, .transverse = 0.03, .axis = z});
  release(wheel);
  wheel.accel = 0;
  unbalance(d, wheel, "turning", {.static_kgm = across, .dynamic_kgm2 = product}, speed);
  d.output("a", 6) = wheel.parent.accel;
  const Eigen::MatrixXcd H = compile(d).transfer({0, speed});
  // b = x, c = y: [cos; sin] to forces and torques along them.
  const double force = across * speed * speed / 6, torque = product * speed * speed / 0.03;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(6, 2);
  right.topRows(2).diagonal().setConstant(force);
  right.middleRows(3, 2).diagonal().setConstant(torque);
  CHECK((H - right).norm() <= 1e-13 * right.norm());
}
