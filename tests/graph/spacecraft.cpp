#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;

namespace {

// As a user types Figs. 17 and 18 of the paper.
Diagram spacecraft(const FlexibleBody& bus, const FlexibleBody& wing, const Rotation& T_ba1,
                   const Rotation& T_ba2) {
  Diagram d{"spacecraft"};   // Figs. 17, 18
  auto U = d.input("U", 6);  // wrench on B at P, in frame b [N; N·m]
  auto B = d.add("B", bus);
  auto A1 = d.add("A1", wing);
  auto A2 = d.add("A2", wing);
  B.parent.force = -U;              // P is free: this channel gets inverted
  mount(A1, B.child("C1"), T_ba1);  // same motion there, wrench back here
  mount(A2, B.child("C2"), T_ba2);
  d.output("xdd_P", 6) = B.parent.accel;
  d.output("xdd_F1", 6) = A1.child("F").accel;
  d.output("xdd_F2", 6) = A2.child("F").accel;
  return d;
}

/// Entries without pattern, below 1.
Eigen::MatrixXd numbers(Eigen::Index rows, Eigen::Index cols, double seed) {
  Eigen::MatrixXd m(rows, cols);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < cols; ++j)
      m(i, j) = std::sin(seed + 1.7 * static_cast<double>(i) + 0.9 * static_cast<double>(j * j));
  return m;
}

ModalData body(double mass, const std::vector<std::string>& children, double seed) {
  ModalData d;
  d.omega = Eigen::Vector3d(3 + seed, 8, 21);
  d.xi = Eigen::Vector3d(0.01, 0.02, 0.005);
  d.L_P = 0.3 * numbers(3, 6, seed);
  d.D_P = rigid_mass(mass, Vector3d(3, 4, 5).asDiagonal(), {0.2, -0.1, 0.3});
  for (const std::string& name : children) {
    const double own = seed + static_cast<double>(d.children.size());
    d.children.push_back({name, numbers(3, 1, own + 5), 0.2 * numbers(6, 3, own)});
  }
  return d;
}

Eigen::MatrixXd on_dual(const Matrix3d& T) {
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(6, 6);
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = T;
  return both;
}

/// Second-order model in q = [x_P; eta_B; eta_1; eta_2], assembled by energy from each body's
/// motion Y q = [x_parent; eta]: M = sum Y' [D_P L'; L I] Y; no joint is solved.
struct ByHand {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(15, 15);
  Eigen::VectorXd K = Eigen::VectorXd::Zero(15), D = K;

  void add(const ModalData& b, const Eigen::MatrixXd& x_parent, Eigen::Index eta) {
    Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(9, 15), m = Eigen::MatrixXd::Identity(9, 9);
    Y.topRows(6) = x_parent;
    Y.block(6, eta, 3, 3).setIdentity();
    m.topLeftCorner(6, 6) = b.D_P;
    m.topRightCorner(6, 3) = b.L_P.transpose();
    m.bottomLeftCorner(3, 6) = b.L_P;
    M += Y.transpose() * m * Y;
    K.segment(eta, 3) = b.omega.cwiseAbs2();
    D.segment(eta, 3) = 2 * b.xi.cwiseProduct(b.omega);
  }
};

}  // namespace

TEST_CASE("the spacecraft as printed gives the transfer of M and K assembled by hand") {
  const ModalData bus = body(90, {"C1", "C2"}, 0.4), wing = body(20, {"F"}, 2.2);
  const Rotation T1 = Rotation::about({1, 2, 0.5}, 0.8), T2 = Rotation::about({0, 0, 1}, 2.9);
  const System system = compile(spacecraft(bus, wing, T1, T2));

  ByHand hand;
  Eigen::MatrixXd x_P = Eigen::MatrixXd::Zero(6, 15);
  x_P.leftCols(6).setIdentity();
  hand.add(bus, x_P, 6);
  Eigen::MatrixXd out(18, 15);
  out.topRows(6) = x_P;
  for (const int i : {0, 1}) {
    const ModalChild& C = bus.children[static_cast<std::size_t>(i)];
    Eigen::MatrixXd x_C = tau(-C.PC) * x_P;
    x_C.middleCols(6, 3) += C.Phi_C;
    const Eigen::MatrixXd x_A = on_dual((i == 0 ? T1 : T2).nominal()).transpose() * x_C;
    const Eigen::Index eta = 9 + 3 * i;
    hand.add(wing, x_A, eta);
    Eigen::MatrixXd x_F = tau(-wing.children[0].PC) * x_A;
    x_F.middleCols(eta, 3) += wing.children[0].Phi_C;
    out.middleRows(6 + 6 * i, 6) = x_F;
  }
  for (const Complex s : {Complex(0, 1.3), Complex(0, 7.1), Complex(0.5, 30)}) {
    Eigen::MatrixXcd Z = s * s * hand.M.cast<Complex>();
    Z.diagonal() += hand.K.cast<Complex>() + s * hand.D.cast<Complex>();
    const Eigen::MatrixXcd q = Z.fullPivLu().solve(x_P.transpose().cast<Complex>());
    const Eigen::MatrixXcd exact = s * s * out.cast<Complex>() * q;
    CHECK(matrix_error(system.transfer(s), exact) <= 1e-12);
    CHECK(matrix_error(system.state_space().transfer(s), exact) <= 1e-12);
  }
  CHECK(system.state_space().order() == 18);
  CHECK(system.state_space().outputs[6] == "xdd_F1(1)");
  // One forced inversion: B's parent channel.
  REQUIRE(system.stage().inversions.size() == 1);
  CHECK(channel_name(system.stage().graph, system.stage().inversions[0].channel) == "B.parent");
}
