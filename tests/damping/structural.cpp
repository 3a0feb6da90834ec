// Structural damping: stiffness (1 + j eta) K at s = j omega, refused in state space.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "scenes/by_hand.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;
using namespace scenes_test;

namespace {

const Complex j(0, 1);

/// One mode along y, clamped: the tip moves by phi per modal coordinate.
FlexibleBody oscillator(double omega, double phi, double eta) {
  ModalData data;
  data.omega = VectorXd::Constant(1, omega);
  data.xi = VectorXd::Constant(1, 0.3);  // replaced
  data.L_P = Eigen::RowVectorXd::Unit(6, 1);
  data.D_P = 2 * Matrix6::Identity();
  data.children = {{"C", {0, 0, 0}, Vector6::Unit(1) * phi}};
  return FlexibleBody{data}.with_loss_factor(eta);
}

Diagram clamped(const FlexibleBody& body) {
  Diagram d{"clamped"};
  auto boom = d.add("boom", body);
  boom.parent.accel = 0;
  boom.child.force = d.input("F", 6);
  d.output("C", 6) = boom.child.accel;
  return d;
}

}  // namespace

TEST_CASE("one oscillator: phi^2 s^2 / (s^2 + (1 + j eta) k), real at 0, conjugate at -omega") {
  const double k = 9, phi = 0.5, eta = 0.04;
  const Diagram d = clamped(oscillator(3, phi, eta));
  const std::vector<double> omega = {0, 0.01, 2.9, 3, 3.3, 40, -3};
  const std::vector<MatrixXcd> H = frequency_response(d, omega);
  REQUIRE(H.size() == omega.size());
  CHECK(H[0].norm() == 0);
  for (std::size_t i = 1; i < omega.size(); ++i) {
    const double w = omega[i];
    const Complex exact =
        -w * w * phi * phi / (k * (1.0 + j * eta * std::copysign(1.0, w)) - w * w);
    CHECK(std::abs(H[i](1, 1) - exact) <= 1e-13 * std::abs(exact));
  }
  // At the resonance as modal damping of xi = eta / 2.
  CHECK(std::abs(H[3](1, 1) - j * phi * phi / eta) <= 1e-13 * phi * phi / eta);
}

TEST_CASE("two beams on a free hub, one with a loss factor: against M and complex K by hand") {
  const Tube tube{1.4, 0.05, 0.046, 2};
  const double eta = 0.03, mass = 40;
  Diagram d{"hub and two beams"};
  auto hub = d.add("hub", RigidBody{.mass = mass,
                                    .inertia = Vector3d(3, 4, 5).asDiagonal(),
                                    .children = {{"A", {0.2, 0, 0}}, {"B", {0.2, 0.3, 0}}}});
  auto a = d.add("a", FlexibleBody{tube.beam()}.with_loss_factor(eta));
  auto b = d.add("b", FlexibleBody{tube.beam()});
  mount(a, hub.child("A"));
  mount(b, hub.child("B"));
  hub.parent.force = -d.input("U", 6);
  d.output("hub", 6) = hub.parent.accel;
  d.output("tip", 6) = a.child.accel;

  const by_hand::FreeBeam fe = by_hand::free_beam(tube.numbers());
  const Index own = 6 * tube.elements, n = 6 + 2 * own;
  MatrixXd M = MatrixXd::Zero(n, n);
  MatrixXcd K = MatrixXcd::Zero(n, n);
  M.topLeftCorner(6, 6).diagonal() << mass, mass, mass, 3, 4, 5;
  MatrixXd tip;
  for (const auto& [first, at, stiff] : {std::tuple{Index{6}, Vector3d(0.2, 0, 0), 1.0 + j * eta},
                                         std::tuple{6 + own, Vector3d(0.2, 0.3, 0), Complex(1)}}) {
    MatrixXd Y = MatrixXd::Zero(6 + own, n);
    Y.leftCols(6) = by_hand::rigid_motion(tube.numbers()) * by_hand::tau(-at);
    Y.block(6, first, own, own).setIdentity();
    M += Y.transpose() * fe.M * Y;
    K.block(first, first, own, own) = stiff * fe.K.bottomRightCorner(own, own);
    if (first == 6) tip = Y.bottomRows(6);
  }
  MatrixXd C(12, n);
  C << MatrixXd::Identity(6, n), tip;
  const std::vector<double> omega = {3, 100, 183, 600, 5000};
  std::vector<MatrixXcd> exact;
  for (const double w : omega)
    exact.push_back(-w * w * C * (K - w * w * M).partialPivLu().solve(MatrixXcd::Identity(n, 6)));
  const std::vector<MatrixXcd> H = frequency_response(d, omega);
  CHECK(error_3(H, exact) <= 1e-9);
  CHECK(frequency_response(d, omega, 1) == H);
  CHECK(frequency_response(parse_diagram(diagram_json(d)), omega) == H);
}

TEST_CASE("without loss factors: the transfers of compile") {
  const Diagram d = clamped(FlexibleBody{Tube{1, 0.05, 0.04, 1}.beam()});
  const std::vector<double> omega = {30, 400};
  CHECK(frequency_response(d, omega) == compile(d).frequency_response(omega));
}

TEST_CASE("loss factors are refused in state space, with the way out, and beside other damping") {
  const FlexibleBody body = oscillator(3, 0.5, 0.04);
  CHECK(says(compile_error(clamped(body)), Code::not_rational,
             {"boom", "0.04", "frequency_response", "0.02"}));
  CHECK(says(error_of([&] { port_hamiltonian(body); }), Code::not_rational, {"0.04"}));
  CHECK(says(error_of([&] { body.block()->response({1, 2}, {}); }), Code::not_rational, {"0.04"}));
  const FlexibleBody plain{body.data()};
  for (const double eta : {0.0, -0.1, std::numeric_limits<double>::infinity()})
    CHECK(says(error_of([&] { plain.with_loss_factor(eta); }), Code::bad_value, {}));
  const MatrixXd Z = MatrixXd::Identity(1, 1);
  CHECK(says(error_of([&] { body.damped_by(Z); }), Code::bad_modes, {}));
  CHECK(says(error_of([&] { plain.damped_by(Z).with_loss_factor(0.1); }), Code::bad_modes, {}));
  CHECK(says(error_of([&] { FlexibleBody(body, {.xi = {{1, 0.1}}}); }), Code::bad_modes, {}));
  const FlexibleBody valued(plain, {.omega = {{1, 4.0}}});
  CHECK(says(error_of([&] { valued.with_loss_factor(0.1); }), Code::bad_modes, {}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(says(error_of([&] { frequency_response(clamped(body), std::vector{nan}); }),
             Code::not_finite, {"clamped"}));
}
