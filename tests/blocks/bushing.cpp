#include <doctest/doctest.h>

#include "hub_and_boom.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Bushings against M, D and K assembled by hand, as the joint between two bodies and between ports
/// of any kind; their refusals.

using namespace joint_test;
using namespace titop;
using titop_test::error_of;
using titop_test::says;

namespace {

/// Symmetric, positive definite, coupled: a diagonal one seen from another point.
Matrix6 seen_from(const Vector3d& offset, const Vector6& diagonal) {
  const Matrix6 t = by_hand::tau(offset);
  const Matrix6 k = t.transpose() * diagonal.asDiagonal() * t;
  return (k + k.transpose()) / 2;
}
const Vector6 kK = (Vector6() << 4e4, 5e4, 9e4, 900, 700, 300).finished();
const Vector6 kC = (Vector6() << 40, 30, 20, 3, 2, 1).finished();

void check(const System& system, const by_hand::Structure& a) {
  const auto exact = exact_transfers(a);
  CHECK(error_3(responses(system, kPoints), exact) <= 1e-10);
  CHECK(error_3(responses(system.state_space(), kPoints), exact) <= 1e-9);
  CHECK(system.state_space().order() == 2 * (6 + 12));
  CHECK(by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(elastic(a, 6))) <=
        1e-9);
}

}  // namespace

TEST_CASE("bushing: a body on it, diagonal and full matrices, against M, D, K") {
  for (const bool coupled : {false, true}) {
    CAPTURE(coupled);
    const Matrix6 K = coupled ? seen_from({0.1, -0.2, 0.05}, kK) : Matrix6(kK.asDiagonal());
    const Matrix6 C = coupled ? seen_from({0, 0.1, 0.1}, kC) : Matrix6(kC.asDiagonal());
    Setup scene;
    const Bushing spec = coupled
                             ? Bushing{.stiffness = K, .damping = C}
                             : Bushing{.stiffness = {4e4, 5e4, 9e4, 900, 700, 300}, .damping = kC};
    auto iso = bushing(scene.d, "iso", scene.boom, scene.hub.child("C"), mounting(), spec);
    auto u = scene.d.input("u", 6);
    scene.hub.child("C").force -= mounting().named("hub", "") * u;
    iso.child.force += u;  // on the boom
    scene.d.output("q", 6) = iso.displacement;
    check(compile(scene.d), assemble(MatrixXd::Identity(6, 6), K, C));
  }
}

TEST_CASE("bushing: between ports of every kind it is the same") {
  const Matrix6 K = seen_from({0.1, -0.2, 0.05}, kK), C = kC.asDiagonal();
  const Bushing spec{.stiffness = K, .damping = C};
  const auto a = assemble(MatrixXd::Identity(6, 6), K, C);
  const auto all = first(12);
  const auto exact = part(exact_transfers(a), all, all);
  {
    Setup scene;  // the boom's parent point is left free: the bushing's `+=` releases it
    bushing(scene.d, "iso", scene.boom.parent, scene.hub.child("C"), mounting(), spec);
    CHECK(error_3(responses(compile(scene.d), kPoints), exact) <= 1e-10);
  }
  {
    Setup scene;  // seen from the hub: the bushing in the hub's frame
    const Matrix3d T = Eigen::AngleAxisd(kAngle, kTurn.normalized()).matrix();
    const Matrix6 TT = by_hand::dual(T);
    Matrix6 Kh = TT * K * TT.transpose();
    Kh = ((Kh + Kh.transpose()) / 2).eval();
    Matrix6 Ch = TT * C * TT.transpose();
    Ch = ((Ch + Ch.transpose()) / 2).eval();
    bushing(scene.d, "iso", scene.hub.child("C"), scene.boom.parent, mounting().inverse(),
            {.stiffness = Kh, .damping = Ch});
    CHECK(error_3(responses(compile(scene.d), kPoints), exact) <= 1e-10);
  }
  {
    Diagram d{"child to child"};  // on a massless adapter in front of the boom
    auto W = d.input("W", 6), F = d.input("F", 6);
    auto h = d.add("hub", hub());
    auto adapter =
        d.add("adapter",
              RigidBody{.mass = 0, .inertia = Matrix3d::Zero(), .children = {{"top"}, {"boom"}}});
    auto boom = d.add("boom", FlexibleBody{kBoom.beam()});
    h.parent.force = -W;
    mount(boom, adapter.child("boom"));
    release(adapter);
    boom.child.force = F;
    bushing(d, "iso", adapter.child("top"), h.child("C"), mounting(), spec);
    d.output("P", 6) = h.parent.accel;
    d.output("tip", 6) = boom.child.accel;
    CHECK(error_3(responses(compile(d), kPoints), exact) <= 1e-10);
  }
}

TEST_CASE("bushing: from the ground, with parameters; positions go through it") {
  Diagram d{"table"};
  const auto k = d.param("k", 100.0);
  auto iso = d.add("iso", Bushing{.stiffness = {k, k, 2 * k, 30, 30, 30}});
  auto table = d.add("table", RigidBody{.mass = 5, .inertia = Matrix3d::Identity()});
  ground(iso);
  mount(table, iso.child);
  iso.child.force += d.input("f", 6);  // on the table
  d.output("x", 6) = table.parent.position;
  d.output("F", 6) = iso.parent.force;
  const System system = compile(d);
  for (const double value : {100.0, 250.0}) {
    const MatrixXd G = system.update({{"k", value}}).state_space().transfer(0).real();
    VectorXd flexibility(6);
    flexibility << 1 / value, 1 / value, 0.5 / value, 1. / 30, 1. / 30, 1. / 30;
    CHECK((G.topRows(6) - MatrixXd(flexibility.asDiagonal())).cwiseAbs().maxCoeff() <= 1e-14);
    CHECK((G.bottomRows(6) - MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff() <= 1e-12);
  }
  const auto poles = system.poles();
  CHECK(titop_test::relative(poles.front().omega, std::sqrt(100.0 / 5)) <= 1e-12);
}

TEST_CASE("bushing: an axis without stiffness is free, unseen it has no states to spare") {
  Diagram d{"bearing"};
  auto iso = d.add("iso", Bushing{.stiffness = {1e5, 1e5, 1e5, 1e3, 1e3, 0}});
  auto rotor = d.add("rotor", RigidBody{.mass = 2, .inertia = Vector3d(1, 1, 2).asDiagonal()});
  ground(iso);
  mount(rotor, iso.child);
  iso.child.force += d.input("f", 6);
  d.output("a", 6) = rotor.parent.accel;
  const MatrixXcd G = compile(d).transfer(Complex(1e-6, 0));
  CHECK(std::abs(G(5, 5) - 0.5) <= 1e-12);  // 1 / I_z
}

TEST_CASE("bushing: matrices that no spring has, by name") {
  const auto refused = [](const Bushing& spec) {
    return error_of([&] {
      Diagram d{"refused"};
      d.add("iso", spec);
    });
  };
  Matrix6 m = kK.asDiagonal();
  CHECK(refused({.stiffness = m}).mistakes().empty());
  CHECK(refused({.stiffness = {}}).mistakes().empty());
  CHECK(says(refused({.stiffness = {1, 1, -2, 1, 1, 1}}), Code::bad_value,
             {"iso", "Bushing", "stiffness", "-2", "z"}));
  CHECK(says(refused({.stiffness = m, .damping = {1, 1, 1, 1, -1, 1}}), Code::bad_value,
             {"iso", "Bushing", "damping", "-1", "ry"}));
  m(0, 4) = 100;
  CHECK(says(refused({.stiffness = m}), Code::bad_value, {"iso", "stiffness", "100", "(1, 5)"}));
  m(0, 4) = m(4, 0) = 1.01 * std::sqrt(kK(0) * kK(4));
  CHECK(says(refused({.stiffness = m}), Code::bad_value, {"iso", "stiffness", "-0.01"}));
  m = kK.asDiagonal();
  m(2, 2) = 0;
  m(2, 3) = m(3, 2) = 5;
  CHECK(says(refused({.stiffness = m}), Code::bad_value, {"iso", "stiffness", "0", "5", "(3, 4)"}));
  m(2, 2) = std::nan("");
  CHECK(says(refused({.stiffness = m}), Code::not_finite, {"iso", "stiffness"}));

  Diagram d{"refused later"};
  const auto k = d.param("k", 10.0);
  auto iso = d.add("iso", Bushing{.stiffness = {k, 1, 1, 1, 1, 1}});
  auto body = d.add("body", RigidBody{.mass = 1, .inertia = Matrix3d::Identity()});
  ground(iso);
  mount(body, iso.child);
  const System system = compile(d);
  CHECK(says(error_of([&] {
               system.update({{"k", -1.0}});
             }),
             Code::bad_value, {"iso", "stiffness", "-1", "x"}));
}

TEST_CASE("bushing: a free end, a body without mass on it") {
  Diagram d{"open"};
  auto iso = d.add("iso", Bushing{.stiffness = kK});
  ground(iso);
  CHECK(says(titop_test::compile_error(d), Code::no_equation, {"iso.child.accel = 0"}));
  auto body = d.add("body", RigidBody{.mass = 0, .inertia = Matrix3d::Zero()});
  mount(body, iso.child);
  iso.child.force += d.input("f", 6);
  d.output("x", 6) = iso.displacement;
  // All is massless: the displacement follows from the force at once.
  const System system = compile(d);
  CHECK(system.order() == 0);
  CHECK(titop_test::matrix_error(system.state_space().D, Matrix6(kK.cwiseInverse().asDiagonal())) <=
        1e-13);
  d.output("a", 6) = body.parent.accel;
  CHECK(says(titop_test::compile_error(d), Code::improper, {"f(1)", "a(1)", "2", "iso"}));
}
