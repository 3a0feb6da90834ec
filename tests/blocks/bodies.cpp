#include <doctest/doctest.h>

#include <cmath>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/fe/scaled.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/hinge.hpp>
#include <titop/blocks/port_hamiltonian.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/invert.hpp>
#include <titop/graph/nodes/lti.hpp>

#include "generate/diagrams/modes.hpp"
#include "matrices.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// RigidBody, FlexibleBody, Hinge and Lti against their equations typed from the paper, their
/// inverses, and their refusals.

using namespace titop;
using namespace blocks_test;
using titop::generate::random_modes;
using titop_test::error_of;
using titop_test::Rng;
using titop_test::says;

namespace {

/// tau from its definition: xdd_C = xdd_P + wdot x PC.
MatrixXd tau_CP(const Vector3d& PC) {
  MatrixXd t = MatrixXd::Identity(6, 6);
  for (int j = 0; j < 3; ++j) t.block<3, 1>(0, 3 + j) = Vector3d::Unit(j).cross(PC);
  return t;
}

/// (14), typed: outputs [xdd_C1; xdd_C2; F_P].
StateSpace equation_14(const ModalData& d) {
  const auto n = d.omega.size(), c = static_cast<Eigen::Index>(d.children.size());
  StateSpace m;
  const MatrixXd K = d.omega.array().square().matrix().asDiagonal();
  const MatrixXd Z = (2 * d.xi.array() * d.omega.array()).matrix().asDiagonal();
  m.A = MatrixXd::Zero(2 * n, 2 * n);
  m.A << MatrixXd::Zero(n, n), MatrixXd::Identity(n, n), -K, -Z;
  m.B = MatrixXd::Zero(2 * n, 6 * c + 6);
  m.C = MatrixXd::Zero(6 * c + 6, 2 * n);
  m.D = MatrixXd::Zero(6 * c + 6, 6 * c + 6);
  for (Eigen::Index i = 0; i < c; ++i) {
    const auto& child = d.children[static_cast<std::size_t>(i)];
    const MatrixXd direct = tau_CP(child.PC) - child.Phi_C * d.L_P;
    m.B.block(n, 6 * i, n, 6) = child.Phi_C.transpose();
    m.C.middleRows(6 * i, 6) << -child.Phi_C * K, -child.Phi_C * Z;
    for (Eigen::Index j = 0; j < c; ++j)
      m.D.block(6 * i, 6 * j, 6, 6) =
          child.Phi_C * d.children[static_cast<std::size_t>(j)].Phi_C.transpose();
    m.D.block(6 * i, 6 * c, 6, 6) = direct;
    m.D.block(6 * c, 6 * i, 6, 6) = direct.transpose();
  }
  m.B.block(n, 6 * c, n, 6) = -d.L_P;
  m.C.bottomRows(6) << d.L_P.transpose() * K, d.L_P.transpose() * Z;
  m.D.bottomRightCorner(6, 6) = -(d.D_P - d.L_P.transpose() * d.L_P);
  return m;
}

}  // namespace

TEST_CASE("FlexibleBody: (14) with none, one and three children") {
  Rng rng(1);
  for (const std::vector<std::string>& children :
       {std::vector<std::string>{}, {"C"}, {"C1", "C2", "C3"}}) {
    const ModalData d = random_modes(rng, 7, children, true);
    const StateSpace exact = equation_14(d);
    CHECK(off(model_of(FlexibleBody(d)), exact) <= 1e-15);
    const auto block = as_block(FlexibleBody(d));
    for (const Complex s : {Complex(0.1, 0.5), Complex(2, 17), Complex(0, 300)}) {
      const auto r = block->response(s, {});
      CHECK(off(r.Y, exact.transfer(s)) <= 1e-12);
      CHECK(off(MatrixXcd(s * r.X - exact.A * r.X), exact.B) <= 1e-11);
    }
  }
}

TEST_CASE("RigidBody: wrenches and accelerations of a rigid body, by Newton and Euler") {
  Rng rng(2);
  const double m = 3;
  const Vector3d PA = rng.matrix(3, 1), PC = rng.matrix(3, 1);
  const Matrix3d T = rng.rotation();
  const Matrix3d half = T * Vector3d(1, 2, 2.5).asDiagonal() * T.transpose();
  const Matrix3d I_A = (half + half.transpose()) / 2;
  const RigidBody spec{.mass = m, .inertia = I_A, .PA = PA, .children = {{"C", PC}}};
  const StateSpace model = model_of(spec);
  CHECK(model.order() == 0);
  for (int i = 0; i < 10; ++i) {
    const Vector3d f = rng.matrix(3, 1), t = rng.matrix(3, 1), a = rng.matrix(3, 1),
                   w = rng.matrix(3, 1);
    VectorXd u(12), y(12);
    u << f, t, a, w;
    // At rest: a_A = a + w x PA; P gets the wrench that does not accelerate the body.
    const Vector3d a_A = a + w.cross(PA);
    const Vector3d F = f - m * a_A;
    y << a + w.cross(PC), w, F, t + PC.cross(f) - I_A * w - m * PA.cross(a_A);
    CHECK(off(VectorXd(model.D * u), y) <= 1e-14);
  }
  CHECK(off(model_of(FlexibleBody(spec)), model) <= 1e-15);
}

TEST_CASE("RigidBody: of very many points, each with its own lever arm") {
  Rng rng(5);
  constexpr int points = 40;
  const double m = 3;
  RigidBody spec{.mass = m, .inertia = Vector3d(2, 3, 4).asDiagonal()};
  for (int i = 0; i < points; ++i)
    spec.children.push_back({"C" + std::to_string(i), rng.matrix(3, 1)});
  const auto model = as_block(spec)->dynamics({});
  CHECK(!model->sparse.empty());
  const VectorXd u = rng.matrix(6 * points + 6, 1);
  const Vector3d a = u.segment<3>(6 * points), w = u.tail<3>();
  VectorXd y(u.size());
  Vector3d F = -m * a, torque = -spec.inertia.nominal() * w;
  for (int i = 0; i < points; ++i) {
    const Vector3d& PC = spec.children[static_cast<std::size_t>(i)].PC.nominal();
    const Vector3d f = u.segment<3>(6 * i);
    y.segment<6>(6 * i) << a + w.cross(PC), w;
    F += f;
    torque += Vector3d(u.segment<3>(6 * i + 3)) + PC.cross(f);
  }
  y.tail<6>() << F, torque;
  CHECK(off(VectorXd(model->dense_direct() * u), y) <= 1e-14);
}

TEST_CASE("Hinge: (18) around a body, G = E M E'") {
  Rng rng(4);
  const Vector3d r = Vector3d(1, -2, 0.5).normalized();
  const StateSpace h = model_of(Hinge{.axis = Vector3d(1, -2, 0.5)});
  VectorXd u = rng.matrix(13, 1);
  VectorXd y(13);
  y << u.segment(6, 6), u.head(6), r.dot(u.segment(3, 3));
  y.segment(3, 3) += r * u(12);
  CHECK(off(VectorXd((h.D * u).head(13)), y) <= 1e-15);
  CHECK(off(h.A, matrix(2, 2, {0, 1, 0, 0})) == 0);
  CHECK(h.B(1, 12) == 1);
  CHECK(h.B.cwiseAbs().sum() == 1);
  CHECK(off(h.C.bottomRows(2), MatrixXd(MatrixXd::Identity(2, 2))) == 0);
  CHECK(says(error_of([] { as_block(Hinge{.axis = Vector3d::Zero()}); }), Code::bad_value,
             {"(0, 0, 0)"}));
}

TEST_CASE("Lti: response, and shapes that do not fit") {
  Rng rng(5);
  const Lti spec{
      .A = rng.matrix(4, 4), .B = rng.matrix(4, 2), .C = rng.matrix(3, 4), .D = rng.matrix(3, 2)};
  const Complex s(0.3, 2);
  const auto r = as_block(spec)->response(s, {});
  const MatrixXcd E = s * MatrixXcd::Identity(4, 4) - spec.A;
  const MatrixXcd X = E.fullPivLu().solve(spec.B.cast<Complex>());
  CHECK(off(r.X, X) <= 1e-14);
  CHECK(off(r.Y, MatrixXcd(spec.C * X + spec.D)) <= 1e-14);
  Lti broken = spec;
  broken.B = rng.matrix(3, 2);
  CHECK(says(error_of([&] { as_block(broken); }), Code::size, {"Lti", "3x2"}));
  broken = spec;
  broken.A(1, 2) = std::nan("");
  CHECK(says(error_of([&] { as_block(broken); }), Code::not_finite, {"Lti"}));
}

TEST_CASE("invert: twice is nothing; whole channels, halves and single degrees of freedom") {
  Rng rng(6);
  const ModalData d = random_modes(rng, 9, {"C"}, true);
  const FlexibleBody body(d);
  const StateSpace M = model_of(body);
  const Complex s(0.4, 3);
  const MatrixXcd G = M.transfer(s);
  for (const std::vector<std::string>& channels : {std::vector<std::string>{"parent"},
                                                   {"C"},
                                                   {"C", "parent"},
                                                   {"parent.linear"},
                                                   {"parent.angular"},
                                                   {"parent(5)"},
                                                   {"C(1)", "parent(3)"},
                                                   {"C.linear", "parent"}}) {
    const StateSpace N = invert(body, channels);
    CAPTURE(channels.front());
    // The exchanged ports have the other's names; then y and u of any motion must satisfy both
    // models.
    MatrixXcd u = rng.matrix(12, 1).cast<Complex>();
    MatrixXcd y = G * u;
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < 12; ++i)
      if (N.inputs[static_cast<std::size_t>(i)] != M.inputs[static_cast<std::size_t>(i)]) {
        pairs.emplace_back(i, i);
        std::swap(u(i), y(i));
      }
    CHECK(!pairs.empty());
    CHECK(off(MatrixXcd(N.transfer(s) * u), y) <= 1e-9);
    CHECK(off(invert(N, pairs), M) <= 1e-10);
    CHECK(N.states == M.states);
  }
}

TEST_CASE("invert: a body is no more singular in micrometres than in metres") {
  Rng rng(7);
  const ModalData d = random_modes(rng, 9, {"C"}, true);
  const std::vector<std::pair<int, int>> back{{6, 6}, {7, 7}, {8, 8}, {9, 9}, {10, 10}, {11, 11}};
  for (const double length : {1e-9, 1e-6, 1e6, 1e9}) {
    const FlexibleBody body(titop::scaled(d, {.length = length}));
    const StateSpace M = model_of(body), N = invert(body, {"parent"});
    CAPTURE(length);
    // The mass that P feels: its inverse times itself, each entry in its own unit.
    MatrixXd one = M.D.bottomRightCorner(6, 6) * N.D.bottomRightCorner(6, 6);
    one.topRightCorner(3, 3) *= length;
    one.bottomLeftCorner(3, 3) /= length;
    CHECK((one - MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff() <= 1e-9);
    CHECK(invert(N, back).inputs == M.inputs);
  }
}

TEST_CASE("invert: the rank is told where the modes cannot move a point") {
  Rng rng(8);
  const ModalData d = random_modes(rng, 4, {"C"}, false);
  CHECK(says(error_of([&] { invert(FlexibleBody(d), {"C"}); }), Code::improper, {"rank 4", "6"}));
}

TEST_CASE("FlexibleBody: port-Hamiltonian form (17), power of the ports less damping") {
  Rng rng(9);
  const ModalData d = random_modes(rng, 6, {"C1", "C2"}, true);
  const PortHamiltonian h = port_hamiltonian(FlexibleBody(d));
  const StateSpace M = model_of(FlexibleBody(d));
  CHECK(off(h.state_space(), M) <= 1e-14);
  for (int i = 0; i < 10; ++i) {
    const VectorXd x = rng.matrix(12, 1), u = rng.matrix(18, 1);
    const VectorXd eta = x.head(6), rate = x.tail(6);
    const VectorXd accel = (M.A * x + M.B * u).tail(6);
    const double power = rate.dot(accel) + rate.dot(d.omega.cwiseAbs2().cwiseProduct(eta));
    const double size = rate.cwiseAbs().dot(accel.cwiseAbs()) +
                        rate.cwiseAbs().dot(d.omega.cwiseAbs2().cwiseProduct(eta.cwiseAbs()));
    CHECK(std::abs(h.supplied(x, u) - h.dissipated(x) - power) <= 1e-13 * size);
    CHECK(h.dissipated(x) >= 0);
  }
}

TEST_CASE("bodies: inertias that no rigid body has") {
  const auto refused = [](double mass, const Matrix3d& inertia) {
    return error_of([&] { as_block(RigidBody{.mass = mass, .inertia = inertia}); });
  };
  CHECK(says(refused(-1, Matrix3d::Identity()), Code::bad_inertia, {"mass", "-1"}));
  CHECK(says(refused(1, Vector3d(1, 1, 2.5).asDiagonal()), Code::bad_inertia, {"1", "2.5"}));
  CHECK(
      says(refused(1, Vector3d(1, 1, -0.5).asDiagonal()), Code::bad_inertia, {"inertia", "-0.5"}));
  Matrix3d skew = Matrix3d::Identity();
  skew(0, 1) = 0.1;
  CHECK(says(refused(1, skew), Code::bad_inertia, {"inertia", "0.1"}));
  CHECK(says(refused(std::nan(""), Matrix3d::Identity()), Code::not_finite, {"mass"}));
  CHECK(refused(1, Vector3d(1, 1, 2).asDiagonal()).mistakes().empty());  // a thin plate
  CHECK(refused(0, Matrix3d::Zero()).mistakes().empty());                // a massless link
}

TEST_CASE("bodies: modal data that contradict themselves, each with its cause") {
  Rng rng(10);
  const ModalData good = random_modes(rng, 5, {"C"}, true);
  const auto refused = [&](auto change) {
    ModalData d = good;
    change(d);
    return error_of([&] { FlexibleBody{d}; });
  };
  CHECK(refused([](ModalData&) {}).mistakes().empty());
  CHECK(says(refused([](ModalData& d) { d.xi.resize(3); }), Code::bad_modes, {"xi", "3 x 1"}));
  CHECK(says(refused([](ModalData& d) { d.L_P = MatrixXd::Zero(4, 6); }), Code::bad_modes,
             {"L_P", "4 x 6"}));
  CHECK(says(refused([](ModalData& d) { d.children[0].Phi_C = MatrixXd::Zero(6, 2); }),
             Code::bad_modes, {"Phi_C", "C", "6 x 2"}));
  CHECK(
      says(refused([](ModalData& d) { d.omega(2) = 0; }), Code::bad_modes, {"mode 3", "omega 0"}));
  CHECK(says(refused([](ModalData& d) { d.xi(1) = -0.1; }), Code::bad_modes, {"mode 2", "-0.1"}));
  CHECK(says(refused([](ModalData& d) { d.L_P(0, 0) = std::nan(""); }), Code::not_finite,
             {"L_P", "nan"}));
  CHECK(says(refused([](ModalData& d) { d.D_P(1, 4) += 0.1 * d.D_P(4, 4); }), Code::bad_inertia,
             {"D_P", "(y, ry)", "(ry, y)"}));
  CHECK(
      says(refused([](ModalData& d) { d.D_P(2, 2) = -1; }), Code::bad_inertia, {"D_P", "-1", "z"}));
  for (int i = 0; i < 3; ++i) {
    // One mode alone that carries twice the mass along one axis: that degree of freedom is named.
    const Error error = refused([i](ModalData& d) {
      d.L_P.setZero();
      d.L_P(0, i) = std::sqrt(2 * d.D_P(i, i));
    });
    CHECK(says(error, Code::bad_modes, {"D_P - L_P' L_P", component_name(i)}));
  }
}

TEST_CASE("bodies: two points of one name") {
  CHECK(says(error_of([] {
               as_block(RigidBody{.children = {{"C"}, {"C"}}});
             }),
             Code::duplicate_name, {"\"C\""}));
  CHECK(says(error_of([] { as_block(RigidBody{.children = {{"parent"}}}); }), Code::duplicate_name,
             {"\"parent\""}));
  Rng rng(11);
  const ModalData d = random_modes(rng, 3, {"C", "C"}, false);
  CHECK(error_of([&] { FlexibleBody{d}; }).has(Code::duplicate_name));
}
