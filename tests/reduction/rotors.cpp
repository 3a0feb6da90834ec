#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <titop/titop.hpp>

#include "../../examples/scenes/cmg.hpp"
#include "../../examples/scenes/wheels.hpp"
#include "against.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"

/// Structures with rotors keep M, D, K and a skew matrix of their momenta: stable and passive by
/// construction at every wheel speed.

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

double least_eigenvalue(const MatrixXcd& hermitian) {
  if (hermitian.size() == 0) return 0;
  return Eigen::SelfAdjointEigenSolver<MatrixXcd>(hermitian, Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

/// M = I, K diagonal, D and K semidefinite, G skew to the last bit; no pole right of the axis
/// [rad/s], beyond the rounding of those at 0.
void check_form(const ReducedSystem& r) {
  const SecondOrderModel m = r.second_order();
  const Eigen::Index n = m.M.rows();
  CHECK(m.M == MatrixXd::Identity(n, n));
  CHECK(m.K == MatrixXd(m.K.diagonal().asDiagonal()));
  CHECK(m.K.diagonal().minCoeff() >= 0);
  CHECK(m.D == MatrixXd(m.D.transpose()));
  CHECK(least_eigenvalue(m.D.cast<std::complex<double>>()) >= -1e-14 * m.D.norm());
  CHECK(m.G == MatrixXd(-m.G.transpose()));
  for (const Pole& p : poles(r.state_space())) CHECK(p.s.real() <= 1e-12);
}

/// The largest frequency of a pole [rad/s].
double fastest(const ReducedSystem& r) {
  double found = 0;
  for (const Pole& p : poles(r.state_space())) found = std::max(found, p.omega);
  return found;
}

/// The error is within the bound, on a grid of its own.
void check_bound(const ReducedSystem& r, const Scene& scene) {
  const ErrorBound& bound = r.bound();
  CHECK(bound.worst <= scene.accuracy);
  const auto exact = [&](std::complex<double> s) {
    return r.full().transfer(s, Precision::twofold);
  };
  const Compared c = compared(scene, fine_points(scene, {}, 200), {exact, {}},
                              [&](std::complex<double> s) { return r.transfer(s); });
  CHECK((c.error.array() <= bound.pairs.array() * bound.peak.array()).all());
}

/// From forces to rates at the same points no energy comes out, in the band and far beyond it:
/// `accel` are the rows of their accelerations.
void check_passive(const ReducedSystem& r, Eigen::Index accel, Eigen::Index count) {
  for (const double w : {1e-3, 0.1, 0.5, 3.0, 30.0, 250.0, 3e3, 1e5}) {
    const std::complex<double> s(1e-3 * w, w);
    const MatrixXcd Y = r.transfer(s).block(accel, 0, count, count) / s;
    const MatrixXcd twice = Y + Y.adjoint();
    CHECK(least_eigenvalue(twice) >= -1e-9 * Y.norm());
  }
}

/// All forms are one model: `rounding` of a pair's peak.
void check_forms(const ReducedSystem& r, double rounding = 1e-9) {
  const SecondOrderModel second = r.second_order();
  const StateSpace dense = r.state_space();
  const ModalModel modal = r.modal();
  for (const std::complex<double> s : {std::complex<double>(0.01, 0.4), {0.3, 11}, {2, 140}}) {
    const MatrixXcd H = r.transfer(s);
    const auto off = [&](const MatrixXcd& other) {
      return (other - H).cwiseAbs().cwiseQuotient(r.bound().peak).maxCoeff();
    };
    CHECK(off(second.transfer(s)) <= rounding);
    CHECK(off(dense.transfer(s)) <= rounding);
    CHECK(off(modal.transfer(s)) <= rounding);
  }
}

const ReductionStep* step(const ReducedSystem& r, const char* name) {
  for (const ReductionStep& s : r.steps())
    if (s.name == name) return &s;
  return nullptr;
}

/// A rigid hub of 400, 500 and 600 kg m^2 with a momentum about y; torques to rates.
Diagram free_hub(double h) {
  Diagram d{"hub"};
  auto hub = d.add("hub", RigidBody{.mass = 1000,
                                    .inertia = Vector3d(400, 500, 600).asDiagonal(),
                                    .children = {{"B", {0.3, -0.2, 0.5}}}});
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -d.input("U", 3);
  momentum(hub.child("B"), h, {0, 1, 0});
  d.output("rate", 3) = hub.parent.rate.angular();
  return d;
}

}  // namespace

TEST_CASE(
    "rotors: wheels of a satellite at any speed keep M, D, G, K, their bound, and passivity") {
  for (const double h : {0.0, 5.0, 40.0, 100.0, 200.0}) {
    CAPTURE(h);
    const Diagram d = scenes::wheels::satellite(h, scenes::wheels::Motors::off);
    const Scene scene{.band_hz = {0.01, 5}, .accuracy = 1e-3};
    const ReducedSystem r = compile(d, scene);
    CAPTURE(to_string(r));
    CHECK(r.order() < r.full().state_space().order());
    check_form(r);
    check_bound(r, scene);
    check_passive(r, 4, 3);
    check_forms(r);
    CHECK((r.second_order().G.norm() > 0) == (h > 0));
    CHECK((step(r, "rotors") != nullptr) == (h > 0));
    if (h == 40) CHECK(has_names(step(r, "rotors")->text, {"40 N m s", "w1.parent", "w4.parent"}));
  }
}

TEST_CASE("rotors: on a plate on springs, with their imbalance as inputs, from 0 Hz") {
  for (const double h : {0.0, 8.0, 50.0}) {
    CAPTURE(h);
    const Diagram d = scenes::wheels::satellite(h, scenes::wheels::Motors::off, true);
    const Scene scene{.band_hz = {0, 40}, .accuracy = 1e-3};
    const ReducedSystem r = compile(d, scene);
    CAPTURE(to_string(r));
    check_form(r);
    check_bound(r, scene);
    check_passive(r, 0, 3);
  }
}

TEST_CASE("rotors: nutation, and G by hand") {
  for (const double h : {50.0, -500.0}) {
    const ReducedSystem r = compile(free_hub(h), Scene{.band_hz = {1e-3, 1}, .accuracy = 1e-9});
    CHECK(r.order() == 3);
    check_form(r);
    const double nutation = std::abs(h) / std::sqrt(400.0 * 600.0);
    const SecondOrderModel m = r.second_order();
    CHECK(std::abs(m.G.norm() / std::sqrt(2.0) / nutation - 1) <= 1e-12);
    CHECK(std::abs(fastest(r) / nutation - 1) <= 1e-12);
    // About z a constant torque about x turns it: w_z = -T_x / h.
    const MatrixXcd H = r.transfer({0, 1e-6 * nutation});
    CHECK(std::abs(H(2, 0).real() * h + 1) <= 1e-9);
    CHECK(std::abs(H(0, 2).real() * h - 1) <= 1e-9);
  }
}

/// A rotor about its axis y, of 0.05 kg m^2 across it, at a point of the ground in a turned frame.
struct OnGround {
  Diagram d{"on ground"};
  Rotor::Handle rotor =
      d.add("rotor", Rotor{.mass = 5, .axial = 0.08, .transverse = 0.05, .axis = {0, 1, 0}});
  RigidBody::Handle base =
      d.add("base",
            RigidBody{.mass = 1, .inertia = Matrix3d::Identity(), .children = {{"C", {1, 2, 3}}}});
  Rotation turn = Rotation::about({1, 2, 2}, 0.7);
  explicit OnGround(double h) {
    ground(base);
    momentum(rotor.parent, h, {0, 1, 0});
    rotor.accel = 0;
  }
};

TEST_CASE("rotors: on a universal joint with springs, (k - I w^2)^2 = (h w)^2") {
  constexpr double h = 40, k = 900, I = 0.05;
  OnGround g(h);
  auto j = joint(g.d, "u", g.rotor, g.base.child("C"), g.turn,
                 {about({1, 0, 0}, "x"), about({0, 0, 1}, "z")});
  for (const char* name : {"x", "z"}) {
    auto axis = j.axis(name);
    axis.force = k * axis.position - g.d.input(std::string("t") + name);
    g.d.output(name) = axis.accel;
  }
  const Scene scene{.band_hz = {0.1, 200}, .accuracy = 1e-6};
  const ReducedSystem r = compile(g.d, scene);
  CAPTURE(to_string(r));
  check_form(r);
  check_bound(r, scene);
  check_passive(r, 0, 2);
  const double root = std::sqrt(h * h + 4 * I * k);
  double slow = HUGE_VAL;
  for (const Pole& p : poles(r.state_space())) slow = std::min(slow, p.omega);
  CHECK(std::abs(slow * 2 * I / (root - h) - 1) <= 1e-12);
  CHECK(std::abs(fastest(r) * 2 * I / (root + h) - 1) <= 1e-12);
}

TEST_CASE("rotors: on oblique gimbals with unequal springs, without equal inertias") {
  const Vector3d axis = Vector3d(1, 2, 2) / 3, x = Vector3d(2, 1, -2) / 3,
                 z = Vector3d(2, -2, 1) / 3;
  for (const double h : {0.5, -40.0}) {
    Diagram d{"gimbals"};
    auto base =
        d.add("base", RigidBody{.mass = 1, .inertia = Matrix3d::Identity(), .children = {{"C"}}});
    ground(base);
    Matrix3d I = Vector3d(0.3, 0.5, 0.7).asDiagonal();
    I(0, 1) = I(1, 0) = 0.1;
    auto frame =
        d.add("frame", RigidBody{.mass = 2, .inertia = I, .children = {{"C", {0.1, 0, 0.2}}}});
    auto rotor = d.add(
        "rotor",
        Rotor{
            .mass = 5, .axial = 0.08, .transverse = 0.05, .axis = axis, .PA = {0.02, 0.03, -0.01}});
    momentum(rotor.parent, h, axis);
    rotor.accel = 0;
    auto outer = hinge(d, "outer", frame, base.child("C"), {}, x);
    auto inner = hinge(d, "inner", rotor, frame.child("C"), {}, z);
    outer.torque = 300 * outer.angle + 0.1 * outer.rate - d.input("t1");
    inner.torque = 900 * inner.angle - d.input("t2");
    d.output("a1") = outer.accel;
    d.output("a2") = inner.accel;
    const Scene scene{.band_hz = {0.1, 200}, .accuracy = 1e-6};
    const ReducedSystem r = compile(d, scene);
    CAPTURE(to_string(r));
    check_form(r);
    check_bound(r, scene);
    check_passive(r, 0, 2);
  }
}

TEST_CASE("rotors: on a damped hinge and on a bushing, whose masses no body's modes determine") {
  const Scene scene{.band_hz = {0.1, 100}, .accuracy = 1e-6};
  for (const bool hinged : {true, false}) {
    CAPTURE(hinged);
    OnGround g(40);
    if (hinged) {
      auto j = hinge(g.d, "drive", g.rotor, g.base.child("C"), g.turn, {0, 0, 1});
      j.torque = 500 * j.angle + 0.2 * j.rate - g.d.input("u");
      g.d.output("accel") = j.accel;
    } else {
      bushing(g.d, "iso", g.rotor, g.base.child("C"), g.turn,
              Bushing{.stiffness = Vector6{1e5, 2e5, 1e5, 500, 700, 600},
                      .damping = Vector6{10, 20, 10, 0.2, 0.1, 0.3}});
      g.rotor.parent.force += -g.d.input("u", 6);
      g.d.output("accel", 6) = g.rotor.parent.accel;
    }
    const ReducedSystem r = compile(g.d, scene);
    CAPTURE(to_string(r));
    check_form(r);
    check_bound(r, scene);
    check_passive(r, 0, hinged ? 1 : 6);
  }
}

TEST_CASE("rotors: a cluster of control moment gyroscopes on compliant gimbals") {
  const Scene scene{.band_hz = {0.01, 30}, .accuracy = 1e-3};
  const ReducedSystem r = compile(scenes::cmg::cluster(), scene);
  CAPTURE(to_string(r));
  check_form(r);
  check_bound(r, scene);
  check_forms(r, 1e-7);  // a torque about one axis hardly turns the hub about another: a difference
                         // of large terms
}

TEST_CASE("rotors: three momenta on one body, more rates than motions") {
  const Vector3d h(30, -20, 45), J(400, 500, 600);
  Diagram d{"hub"};
  auto hub = d.add("hub", RigidBody{.mass = 1000,
                                    .inertia = J.asDiagonal(),
                                    .children = {{"A", {0.3, -0.2, 0.5}}, {"B", {-0.1, 0.4, 0}}}});
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -d.input("U", 3);
  momentum(hub.parent, h(0), {1, 0, 0});
  momentum(hub.child("A"), h(1), {0, 1, 0});
  momentum(hub.child("B"), h(2), {0, 0, 1});
  d.output("rate", 3) = hub.parent.rate.angular();
  const ReducedSystem r = compile(d, Scene{.band_hz = {1e-3, 1}, .accuracy = 1e-9});
  CAPTURE(to_string(r));
  check_form(r);
  const double nutation = std::sqrt(h.dot(J.asDiagonal() * h) / J.prod());
  CHECK(std::abs(fastest(r) / nutation - 1) <= 1e-12);
  // J w' + w x h = T, h in the body.
  Eigen::Matrix3cd Z = Eigen::Matrix3cd::Zero();
  const std::complex<double> s(0.01, 0.07);
  Z.diagonal() = s * J;
  Z += (Eigen::Matrix3d() << 0, h(2), -h(1), -h(2), 0, h(0), h(1), -h(0), 0).finished();
  const Eigen::Matrix3cd exact = Z.inverse();
  CHECK((r.transfer(s) - exact).norm() <= 1e-12 * exact.norm());
}

TEST_CASE("rotors: the energy of a reduced model with momenta, which do no work") {
  const Diagram d = scenes::wheels::satellite(40, scenes::wheels::Motors::off);
  const ReducedSystem r =
      compile(d, Scene{.outputs = {"turn"}, .band_hz = {0.01, 5}, .accuracy = 1e-3});
  const PortHamiltonian p = port_hamiltonian(r.second_order());
  CHECK(p.J == MatrixXd(-p.J.transpose()));
  const std::complex<double> s(0.02, 3);
  const MatrixXcd H = r.transfer(s);
  CHECK((p.state_space().transfer(s) - H).norm() <= 1e-9 * H.norm());
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(p.Q.rows(), 1, 2),
                        rate = p.state_space().A * x;
  CHECK(std::abs(x.dot(p.Q * rate) + p.dissipated(x)) <= 1e-12 * (p.Q * x).norm() * rate.norm());
}

TEST_CASE("rotors: a law between wheels and hub is no structure; the force and the way out") {
  const Diagram d = scenes::wheels::satellite(40, scenes::wheels::Motors::law);
  const ReducedSystem r =
      compile(d, Scene{.outputs = {"turn"}, .band_hz = {0, 5}, .accuracy = 1e-3});
  CHECK(says(error_of([&] { r.second_order(); }), Code::bad_value, {"w1.torque", "state_space()"}));
}
