// The block of a rotor: parameters, mistakes, its motor, imbalance.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <titop/titop.hpp>
#include <tuple>

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
  const Param m = d.param("m", 6), I_a = d.param("I_a", 0.05), I_t = d.param("I_t", 0.04),
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
  const std::map<std::string, double> at = {{"m", 5.5}, {"I_a", 0.052}, {"I_t", 0.041}, {"h", -11}};
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

TEST_CASE("imbalance: as two masses off the axis, at any point of the rotor") {
  // Masses m1 at (e, 0, z1) and m2 at (-e, 0, z2) from A turn about z: force m e Omega^2 of each,
  // and its moment about P.
  const double speed = 30, e = 0.1, m1 = 3e-3, m2 = 1e-3, z1 = 0.05, z2 = -0.02;
  const Vector3d PA(0.04, 0.07, 0.2);
  const double across = (m1 - m2) * e, product = m1 * e * z1 - m2 * e * z2;
  const auto wrench = [&](double angle) {
    Vector6 sum = Vector6::Zero();
    for (const auto& [m, side, up] : {std::tuple(m1, 1.0, z1), std::tuple(m2, -1.0, z2)}) {
      const Vector3d out = side * Vector3d(std::cos(angle), std::sin(angle), 0);
      const Vector3d force = m * e * speed * speed * out;
      sum.head<3>() += force;
      sum.tail<3>() += (PA + e * out + up * z).cross(force);
    }
    return sum;
  };
  Diagram d{"imbalance"};
  auto wheel =
      d.add("wheel", Rotor{.mass = 6, .axial = 0.05, .transverse = 0.03, .axis = z, .PA = PA});
  ground(wheel);
  wheel.accel = 0;
  unbalance(d, wheel, "turning", {.static_kgm = across, .dynamic_kgm2 = product}, speed);
  d.output("load", 6) = wheel.parent.reaction;
  const Eigen::MatrixXcd H = compile(d).transfer({0, speed});
  for (const double angle : {0.0, 1.0, 2.5}) {
    const Eigen::Vector2cd wave(std::cos(angle), std::sin(angle));
    const Vector6 right = wrench(angle);
    CHECK((H * wave - right).norm() <= 1e-13 * right.norm());
  }
  CHECK(says(error_of([&] {
               Diagram other{"other"};
               unbalance(other, wheel, "turning", {.static_kgm = 1}, speed);
             }),
             Code::unknown_name, {"other"}));
}

TEST_CASE("momentum without a direction or a number is refused at its port") {
  Diagram d{"wrong"};
  auto hub = d.add("hub", RigidBody{.children = {{"B"}}});
  CHECK(says(error_of([&] { momentum(hub.child("B"), 4, Vector3d::Zero()); }), Code::bad_value,
             {"hub", "B"}));
  CHECK(says(error_of([&] { momentum(hub.parent, NAN, z); }), Code::not_finite, {"hub.parent"}));
  CHECK(says(error_of([&] { momentum(DualPort<6>{}, 4, z); }), Code::unknown_name, {"momentum"}));
}

TEST_CASE("a rotor with momentum that is not mounted is not driven") {
  Diagram d{"forgotten"};
  auto wheel = d.add("wheel", Rotor{.momentum = 40});
  wheel.accel = 0;
  d.output("accel", 6) = wheel.parent.accel;
  CHECK(says(error_of([&] { compile(d); }), Code::no_equation, {"wheel.parent"}));
  release(wheel);
  CHECK(compile(d).outputs().size() == 6);
}

TEST_CASE("momentum as a parameter: from 0 and back") {
  const auto satellite = [](double h) {
    Diagram d{"bias"};
    const Param bias = d.param("h", h);
    auto hub = d.add("hub", RigidBody{.mass = 9, .inertia = Vector3d(4, 5, 6).asDiagonal()});
    hub.parent.force = -d.input("U", 6);
    momentum(hub.parent, bias, {1, 2, 3});
    d.output("rate", 3) = hub.parent.rate.angular();
    return compile(d);
  };
  const System at_0 = satellite(0), at_40 = satellite(40);
  const std::complex<double> s(0.3, 2);
  const Eigen::MatrixXcd with = at_40.transfer(s), without = at_0.transfer(s);
  CHECK((at_0.update({{"h", 40}}).transfer(s) - with).norm() <= 1e-13 * with.norm());
  CHECK((at_40.update({{"h", 0}}).transfer(s) - without).norm() <= 1e-13 * without.norm());
}

TEST_CASE("a momentum that is a parameter occurs twice, at any port and about any axis") {
  for (const Vector3d& axis : {Vector3d(0, 1, 0), Vector3d(1, -2, 2)})
    for (const bool at_tip : {false, true}) {
      CAPTURE(at_tip);
      Diagram d{"bias"};
      const Param h = d.param("h", 20);
      auto hub = d.add("hub", RigidBody{.mass = 90,
                                        .inertia = Vector3d(40, 50, 60).asDiagonal(),
                                        .children = {{"B", {0.5, 0, 0}}}});
      auto boom = d.add("boom", FlexibleBody{Beam{.length = 2,
                                                  .section = rectangle(0.06, 0.04),
                                                  .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                                  .elements = 1}});
      mount(boom, hub.child);
      if (at_tip)
        momentum(boom.child, h, axis);
      else
        momentum(hub.parent, h, axis);
      hub.parent.force += -1.0 * d.input("U", 6);
      d.output("accel", 6) = hub.parent.accel;
      const System system = compile(d);
      const Lft f = lft(system, {{"h", between(-30, 40)}});
      REQUIRE(f.deltas().size() == 1);
      CHECK(f.deltas()[0].size == 2);
      const std::complex<double> s(0.4, 1.3);
      const Eigen::MatrixXcd right = system.update({{"h", -7}}).transfer(s);
      CHECK((f.at({{"h", -7}}).transfer(s) - right).norm() <= 1e-11 * right.norm());
    }
}
