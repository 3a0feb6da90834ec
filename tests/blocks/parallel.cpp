#include <doctest/doctest.h>

#include "hub_and_boom.hpp"

/// Bushings in parallel, and loops with joints of several axes: closed chains.

using namespace joint_test;
using namespace titop;

TEST_CASE("bushings in parallel: the sum of both, without states of their own") {
  const Vector6 k = (Vector6() << 4e4, 5e4, 9e4, 900, 700, 300).finished();
  const Vector6 c = (Vector6() << 40, 30, 20, 3, 2, 1).finished();
  const std::vector<Vector3d> legs{{0.2, 0, 0}, {-0.1, 0.2, 0}, {-0.1, -0.2, 0.05}};
  for (const bool hung : {true, false}) {
    CAPTURE(hung);
    Diagram d{"isolated"};
    auto W = d.input("W", 6), F = d.input("F", 6);
    RigidBody below = hub(), plate{.mass = 0, .inertia = Matrix3d::Zero(), .children = {{"boom"}}};
    for (std::size_t i = 0; i < 3; ++i) {
      // The same points, seen from the hub's P and from the plate, which is turned.
      const Matrix3d T = Eigen::AngleAxisd(kAngle, kTurn.normalized()).matrix();
      below.children.push_back({"leg" + std::to_string(i), kPC + T * legs[i]});
      plate.children.push_back({"leg" + std::to_string(i), legs[i]});
    }
    auto h = d.add("hub", below);
    auto p = d.add("plate", plate);
    auto boom = d.add("boom", FlexibleBody{kBoom.beam()});
    h.parent.force = -W;
    mount(boom, p.child("boom"));
    boom.child.force = F;
    const Bushing spec{.stiffness = k, .damping = c};
    if (hung) {
      auto adapter =
          d.add("adapter",
                RigidBody{.mass = 0, .inertia = Matrix3d::Zero(), .children = {{"C", -legs[0]}}});
      bushing(d, "iso0", adapter, h.child("leg0"), mounting(), spec);
      mount(p, adapter.child);
    } else {
      release(p);
      bushing(d, "iso0", p.child("leg0"), h.child("leg0"), mounting(), spec);
    }
    for (const char* leg : {"leg1", "leg2"})
      bushing(d, std::string("iso_") + leg, p.child(leg), h.child(leg), mounting(), spec);
    d.output("P", 6) = h.parent.accel;
    d.output("tip", 6) = boom.child.accel;
    const System system = compile(d);

    Matrix6 K = Matrix6::Zero(), C = Matrix6::Zero();
    for (const Vector3d& leg : legs) {
      const Matrix6 t = by_hand::tau(-leg);
      K += t.transpose() * k.asDiagonal() * t;
      C += t.transpose() * c.asDiagonal() * t;
    }
    const auto a = assemble(MatrixXd::Identity(6, 6), K, C);
    const auto all = first(12);
    const auto exact = part(exact_transfers(a), all, all);
    CHECK(error_3(responses(system, kPoints), exact) <= 1e-10);
    CHECK(error_3(responses(system.state_space(), kPoints), exact) <= 1e-9);
    CHECK(system.state_space().order() == 2 * 18);
    CHECK(by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(elastic(a, 6))) <=
          1e-9);
  }
}

TEST_CASE("slider-crank as a closed chain, in the posture that `posture` finds") {
  const double crank = 0.3, rod = 0.9, theta = 0.8;
  const Vector3d z(0, 0, 1);
  const Posture p = posture({{.joint = about(z), .given = theta, .link = {crank, 0, 0}},
                             {.joint = about(z), .guess = -1, .link = {rod, 0, 0}},
                             {.joint = about(z)},
                             {.joint = along({-1, 0, 0}), .guess = 1}});
  Diagram d{"slider-crank"};
  auto u = d.input("tau");
  auto ground_at = d.add("bench", RigidBody{.mass = 1,
                                            .inertia = Matrix3d::Identity(),
                                            .children = {{"O"}, {"S", -p.offset[3]}}});
  auto c = d.add("crank", RigidBody{.mass = 2,
                                    .inertia = 0.1 * Matrix3d::Identity(),
                                    .PA = {0.1, 0, 0},
                                    .children = {{"A", {crank, 0, 0}}}});
  auto r = d.add("rod", RigidBody{.mass = 1,
                                  .inertia = 0.2 * Matrix3d::Identity(),
                                  .PA = {0.4, 0, 0},
                                  .children = {{"B", {rod, 0, 0}}}});
  auto piston = d.add(
      "piston", RigidBody{.mass = 3, .inertia = 0.1 * Matrix3d::Identity(), .children = {{"B"}}});
  ground(ground_at);
  auto O = hinge(d, "O", c, ground_at.child("O"), p.T_ba[0], z);
  auto A = hinge(d, "A", r, c.child, p.T_ba[1], z);
  auto S = slide(d, "S", piston, ground_at.child("S"), {}, {1, 0, 0});
  auto pin = d.add("B", Hinge{z});
  mount(pin, r.child, p.T_ba[2]);
  weld(piston.child, pin.child);
  O.torque = -u;
  A.torque = 0;
  pin.torque = 0;
  S.force = 500 * S.travel;
  d.output("theta") = O.angle;
  d.output("x") = S.travel;
  const System system = compile(d);
  // One degree of freedom: dx/dtheta and dphi/dtheta of the slider-crank.
  const double phi = std::asin(-crank / rod * std::sin(theta));  // of the rod
  const double phi_t = -crank * std::cos(theta) / (rod * std::cos(phi));
  const double x_t = -crank * std::sin(theta) - rod * std::sin(phi) * phi_t;
  const Eigen::Vector2d rod_A(-crank * std::sin(theta) - 0.4 * std::sin(phi) * phi_t,
                              crank * std::cos(theta) + 0.4 * std::cos(phi) * phi_t);
  const double M = 0.1 + 2 * 0.01 + 0.2 * phi_t * phi_t + rod_A.squaredNorm() + 3 * x_t * x_t;
  const double K = 500 * x_t * x_t;
  CHECK(system.state_space().order() == 2);
  for (const Complex s : {Complex(0.2, 1), Complex(1, 7), Complex(2, 40)}) {
    const MatrixXcd G = system.transfer(s);
    const Complex exact = 1.0 / (M * s * s + K);
    CHECK(std::abs(G(0, 0) - exact) <= 1e-11 * std::abs(exact));
    CHECK(std::abs(G(1, 0) - x_t * exact) <= 1e-11 * std::abs(exact));
  }
}
