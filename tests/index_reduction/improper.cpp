#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/compiler/definition/transfer.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "scenes/by_hand.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// A derivative that reaches an output is refused however small its share is at some frequency:
/// above that frequency it dominates. A share at rounding level is none.

using namespace scenes_test;
using namespace titop;
using namespace titop_test;

namespace {

/// A force on the massless end of a spring, on which another spring with a mass is mounted. The
/// end's own motion is a share of the output.
Diagram seen_by(double share, bool rate) {
  Diagram d{"loaded"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 7, .stiffness = 30}),
       z2 = d.add("z2", SpringMass{.mass = 2, .stiffness = 50});
  z1.child.accel = 0;
  z2.parent.accel = z1.parent.accel;
  z1.parent.force = -u - z2.parent.force;
  if (rate)
    d.output("y") = z2.stretch + share * z1.parent.rate;
  else
    d.output("y") = z2.child.accel + share * z1.parent.accel;
  return d;
}

/// An actuator without mass on a stiff bracket of a hub that carries slow pendula.
Diagram bracket(int pendula) {
  Diagram d{"bracket"};
  auto u = d.input("u");
  auto hub = d.add("hub", SpringMass{.mass = 1000, .stiffness = 1}),
       link = d.add("link", SpringMass{.mass = 1, .stiffness = 1e12});
  ground(hub.parent);
  weld(link.child, hub.child);
  link.parent.force = -u;
  for (int i = 0; i < pendula; ++i)
    mount(d.add(fmt::format("p{}", i),
                SpringMass{.mass = 100.0 / pendula, .stiffness = 10.0 / pendula}),
          hub.child);
  d.output("a_link") = link.parent.accel;
  return d;
}

/// Symmetric, positive definite, with stiffnesses over so many decades.
Matrix6 random_stiffness(Rng& rng, double decades) {
  Matrix6 a, b = Matrix6::Zero();
  for (double& entry : a.reshaped()) entry = rng.between(-1, 1);
  for (int i = 0; i < 6; ++i) b(i, i) = std::pow(10, rng.between(0, decades));
  const Matrix6 q = Eigen::HouseholderQR<Matrix6>(a).householderQ(), k = q * b * q.transpose();
  return (k + k.transpose()) / 2;
}

Vector3d random_vector(Rng& rng) {
  return {rng.between(-1, 1), rng.between(-1, 1), rng.between(-1, 1)};
}

}  // namespace

TEST_CASE("improper: a derivative's share is refused down to rounding") {
  for (double share = 1e-3; share > 5e-13; share /= 10) {
    CAPTURE(share);
    CHECK(needs_derivatives(compile_error(seen_by(share, false)), "u", "y", 2));
    CHECK(needs_derivatives(compile_error(seen_by(share, true)), "u", "y", 1));
  }
  CHECK(compile_error(seen_by(0, false)).mistakes().empty());
  CHECK(compile_error(seen_by(0, true)).mistakes().empty());
}

TEST_CASE("improper: a stiff bracket, whatever slow pendula the hub carries") {
  for (const int pendula : {0, 1, 3, 10, 30}) {
    CAPTURE(pendula);
    CHECK(needs_derivatives(compile_error(bracket(pendula)), "u", "a_link", 2));
  }
}

TEST_CASE("improper: a direction across the motion at once is none, to rounding") {
  Rng rng(5);
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    Diagram d{"across"};
    auto u = d.input("u");
    auto hub = d.add("hub", RigidBody{.mass = 20,
                                      .inertia = Matrix3d::Identity() * 3,
                                      .children = {{"C", random_vector(rng)}}});
    auto iso = d.add("iso", Bushing{.stiffness = random_stiffness(rng, 1)});
    ground(iso);
    mount(hub, iso.child);
    const Matrix6 K = random_stiffness(rng, i % 4);
    const Matrix6 C = i % 2 ? Matrix6(0.3 * K) : Matrix6::Zero();
    auto arm = d.add("arm", Bushing{.stiffness = K, .damping = C});
    const double angle = rng.between(0, 3);
    mount(arm, hub.child("C"), Rotation::about(random_vector(rng), angle));
    // The arm's end gives way to the wrench along `at_once`: the reading is across that.
    Vector6 wrench, read;
    wrench << random_vector(rng), random_vector(rng);
    read << random_vector(rng), random_vector(rng);
    const Vector6 at_once = K.ldlt().solve(wrench);
    read -= read.dot(at_once) / at_once.squaredNorm() * at_once;
    arm.child.force = Eigen::MatrixXd(wrench) * u;
    d.output("y") = Eigen::MatrixXd(read.transpose()) * arm.child.accel;
    const Error refused = compile_error(d);
    CAPTURE(std::string(refused.what()));
    REQUIRE(refused.mistakes().empty());
    const System system = compile(d);
    for (const Complex s : {Complex(0.2, 0.3), Complex(0.1, 1.7)})
      worst = std::max(
          worst, relative(system.state_space().transfer(s)(0, 0), transfer(d.graph(), s)(0, 0)));
  }
  CAPTURE(worst);
  CHECK(worst <= 1e-10);
}

TEST_CASE("improper: across by a right angle whose cosine is 6e-17 is across") {
  const double cosine = std::cos(std::acos(-1.0) / 2);
  REQUIRE(cosine != 0);
  Diagram d{"right angle"};
  auto u = d.input("u");
  auto hub = d.add("hub", RigidBody{.mass = 20,
                                    .inertia = Matrix3d::Identity() * 3,
                                    .children = {{"C", {0.3, 0.2, 0.5}}}});
  auto iso = d.add("iso", Bushing{.stiffness = {10, 20, 30, 5, 6, 7}});
  ground(iso);
  mount(hub, iso.child);
  auto arm = d.add("arm", Bushing{.stiffness = {40, 50, 60, 9, 8, 7}});
  mount(arm, hub.child("C"));
  const Vector6 along = (Vector6() << cosine, 1, 0, 0, 0, 0).finished();
  arm.child.force = Eigen::MatrixXd(along) * u;
  d.output("y") = Eigen::MatrixXd(Vector6::Unit(0).transpose()) * arm.child.accel;
  const Error refused = compile_error(d);
  CAPTURE(std::string(refused.what()));
  CHECK(refused.mistakes().empty());
}
