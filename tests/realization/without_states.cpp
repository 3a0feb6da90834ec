#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "support/rng.hpp"

/// A, B, C, D of models without states: D alone.

using namespace titop;
using titop_test::Rng;

namespace {

/// A hub whose mass a force by its own acceleration cancels to 4e-6 of it, and two signals in a
/// loop of gain 0.996 that this acceleration drives and that push the hub: no states.
struct AlmostMassless {
  double mass, cancelled = mass * (1 - 0x1p-18), forward = 19.92, back = 0.05;
  Eigen::Vector3d at_sensor{0, 0, -0.97}, at_thruster{0, -0.6, -1};
  Eigen::MatrixXd sense =
                      (Eigen::MatrixXd(2, 6) << 0, 1, 0, 0, 0, -1, 0.8, 1, 0, 0, 0, 0).finished(),
                  push = (Eigen::MatrixXd(3, 2) << -25, -57, -15, -9, -14, 33).finished() / 1e3;

  System system() const {
    Diagram d{"almost massless"};
    const auto u = d.input("u", 3);
    auto hub =
        d.add("hub", RigidBody{.mass = mass,
                               .inertia = {1, 1, 1},
                               .children = {{"sensor", at_sensor}, {"thruster", at_thruster}}});
    auto out = d.add("out", Gain{.gain = forward, .size = 2});
    auto in = d.add("in", Gain{.gain = back, .size = 2});
    release(hub);
    in.in = out.out;
    out.in = in.out + sense * hub.child("sensor").accel;
    auto mass_like = d.add("mass_like", Gain{.gain = cancelled, .size = 3});
    mass_like.in = Eigen::MatrixXd::Identity(3, 3) * hub.parent.accel.linear;
    hub.parent.force.linear += -(Eigen::MatrixXd::Identity(3, 3) * mass_like.out);
    hub.child("sensor").force.angular += u;
    hub.child("thruster").force.linear += push * out.out;
    d.output("y", 2) = out.out;
    return compile(d);
  }

  /// y from u, by hand, in 64 bits of mantissa.
  Eigen::MatrixXd exact() const {
    using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    const auto cross = [](const Eigen::Vector3d& r) {
      Long m(3, 3);
      m << 0, -r(2), r(1), r(2), 0, -r(0), -r(1), r(0), 0;
      return m;
    };
    // [force; torque] on the hub from y; acceleration of the sensor from them.
    Long wrench(6, 2), accel = Long::Identity(6, 6);
    wrench << push.cast<long double>(), cross(at_thruster) * push.cast<long double>();
    accel.topLeftCorner(3, 3) /= (long double)(mass)-cancelled;
    accel.topRightCorner(3, 3) = -cross(at_sensor);
    const Long S = sense.cast<long double>() * accel;
    const long double open = 1 - (long double)(forward)*back, p = forward;
    const Long loop = open * Long::Identity(2, 2) - p * S * wrench;
    Long inverse(2, 2);
    inverse << loop(1, 1), -loop(0, 1), -loop(1, 0), loop(0, 0);
    inverse /= loop(0, 0) * loop(1, 1) - loop(0, 1) * loop(1, 0);
    return (p * inverse * S.rightCols(3)).cast<double>();
  }
};

}  // namespace

TEST_CASE("dense export: D of a model without states keeps its digits, or the certificate tells") {
  Rng rng(11);
  for (int i = 0; i < 50; ++i) {
    CAPTURE(i);
    const AlmostMassless scene{.mass = rng.between(20, 40)};
    const System system = scene.system();
    REQUIRE(system.order() == 0);
    const Eigen::MatrixXd exact = scene.exact();
    const double size = exact.cwiseAbs().maxCoeff();
    CHECK((system.transfer(1.0).real() - exact).cwiseAbs().maxCoeff() <= 1e-11 * size);
    CHECK((system.state_space().D - exact).cwiseAbs().maxCoeff() <= 1e-9 * size);
    CHECK(system.dense_certificate().dense_error <= 1e-9);
    StateSpace written;
    system.write(written);
    written.D(0, i % 3) += 1e-7 * size;
    const double said = system.certificate(written).dense_error;
    CHECK(said >= 3e-8);
    CHECK(said <= 1e-6);
  }
}
