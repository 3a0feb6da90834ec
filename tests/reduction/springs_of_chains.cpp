#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <optional>
#include <set>
#include <titop/titop.hpp>

/// Closed planar chains with springs on some of their pins only, also where none is on the
/// coordinate that remains: M and K by hand.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

const double kLength[] = {1, 0.8, 1.1, 0.9}, kTurn[] = {0.9, -0.7, -0.9, 0.3},
             kSpring[] = {30, 50, 70, 90, 110};

/// Directions of the links [rad].
Eigen::VectorXd directions(int links) {
  Eigen::VectorXd a(links);
  for (int i = 0; i < links; ++i) a(i) = kTurn[i] + (i > 0 ? a(i - 1) : 0);
  return a;
}

/// Links between two points of the ground, on pins about z; a torque at the first one.
Diagram chain(int links, const std::set<int>& sprung) {
  Diagram d{"chain"};
  const Vector3d z(0, 0, 1);
  const Eigen::VectorXd a = directions(links);
  Vector3d end = Vector3d::Zero();
  for (int i = 0; i < links; ++i) end += kLength[i] * Vector3d(std::cos(a(i)), std::sin(a(i)), 0);
  auto base = d.add("base", RigidBody{.mass = 1,
                                      .inertia = Matrix3d::Identity(),
                                      .children = {{"A", {0, 0, 0}}, {"B", end}}});
  ground(base);
  std::optional<RigidBody::Handle> before;
  for (int i = 0; i <= links; ++i) {
    const std::string number = std::to_string(i);
    const bool last = i == links;
    auto pin = d.add("p" + number, Hinge{.axis = z});
    Expr torque = (sprung.contains(i) ? kSpring[i] : 0.0) * pin.angle;
    pin.torque = i == 0 ? torque - d.input("u") : torque;
    if (i == 0) d.output("accel") = pin.accel;
    if (last) {
      mount(pin, base.child("B"));
      weld(before->child("end"), pin.child, Rotation::about(z, a(links - 1)));
      break;
    }
    mount(pin, before ? before->child("end") : base.child("A"));
    auto link = d.add("l" + number, RigidBody{.mass = 1.0 + i,
                                              .inertia = 0.1 * (1 + i) * Matrix3d::Identity(),
                                              .PA = {kLength[i] / 2, 0, 0},
                                              .children = {{"end", {kLength[i], 0, 0}}}});
    mount(link, pin.child, Rotation::about(z, kTurn[i]));
    before = link;
  }
  return d;
}

/// Acceleration of the first pin per torque there, from the links' absolute angles.
std::complex<double> by_hand(int links, const std::set<int>& sprung, std::complex<double> s) {
  const Eigen::VectorXd a = directions(links);
  MatrixXd M = MatrixXd::Zero(links, links), K = M, J = MatrixXd::Zero(2, links);
  for (int i = 0; i < links; ++i) {
    MatrixXd V = J;  // velocity of the centre of link i
    V.col(i) = kLength[i] / 2 * Eigen::Vector2d(-std::sin(a(i)), std::cos(a(i)));
    M += (1.0 + i) * V.transpose() * V;
    M(i, i) += 0.1 * (1 + i);
    J.col(i) = 2 * V.col(i);
  }
  for (const int i : sprung) {
    Eigen::RowVectorXd q = Eigen::RowVectorXd::Zero(links);  // of pin i
    if (i < links) q(i) = 1;
    if (i > 0) q(i - 1) = -1;
    K += kSpring[i] * q.transpose() * q;
  }
  const MatrixXd T = Eigen::FullPivLU<MatrixXd>(J).kernel();
  const MatrixXcd Z = T.transpose() * (s * s * M + K) * T;
  const Eigen::VectorXcd first = T.row(0).transpose();
  return s * s * first.transpose() * Z.inverse() * first;
}

}  // namespace

TEST_CASE("closed chains with springs on some pins keep M and K") {
  for (const int links : {3, 4})
    for (const std::set<int>& sprung :
         {std::set{0}, {1}, {links}, {0, 1}, {2, 3}, {links - 1, links}, {0, links}}) {
      CAPTURE(links);
      CAPTURE(*sprung.begin());
      CAPTURE(*sprung.rbegin());
      if (static_cast<int>(sprung.size()) < links - 2) continue;  // a mechanism is left
      const Diagram d = chain(links, sprung);
      const ReducedSystem r = compile(d, Scene{.band_hz = {0.01, 20}, .accuracy = 1e-9});
      const SecondOrderModel m = r.second_order();
      CHECK(m.K.diagonal().minCoeff() > 0);
      for (const std::complex<double> s : {std::complex<double>(1.3, 2), {0.1, 7}, {0.5, 30}}) {
        const std::complex<double> right = by_hand(links, sprung, s);
        CHECK(std::abs(r.transfer(s)(0, 0) - right) <= 1e-8 * std::abs(right));
      }
    }
}
