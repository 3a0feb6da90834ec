#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <titop/titop.hpp>

/// Bodies whose damping couples their modes keep M, D, K: M = I, D = Z, K = diag(omega^2) by hand.

using namespace titop;
using Eigen::Matrix2d;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

const Matrix2d kShapes{{0.7, 0.2}, {0.1, 0.8}};  ///< of the point, along x and y

ModalData two_modes() {
  ModalData data;
  data.omega = Eigen::Vector2d(3, 7);
  data.xi = Eigen::Vector2d::Zero();
  data.L_P = MatrixXd::Zero(2, 6);
  data.L_P(0, 0) = 0.5, data.L_P(1, 1) = 0.4;
  data.D_P = Eigen::Vector<double, 6>(2, 2, 2, 1, 1, 1).asDiagonal();
  MatrixXd Phi = MatrixXd::Zero(6, 2);
  Phi.topRows(2) = kShapes;
  data.children = {{"c", {1, 0, 0}, Phi}};
  return data;
}

}  // namespace

TEST_CASE("a cantilever whose damping matrix couples its modes") {
  for (const double coupling : {0.3, -0.59, 0.0}) {
    CAPTURE(coupling);
    const Matrix2d Z{{0.4, coupling}, {coupling, 0.9}};
    Diagram d{"cantilever"};
    auto boom = d.add("boom", FlexibleBody{two_modes()}.damped_by(Z));
    ground(boom);
    boom.child("c").force += d.input("F", 6);
    d.output("a", 6) = boom.child("c").accel;
    const ReducedSystem r = compile(d, Scene{.inputs = {"F(1)", "F(2)"},
                                             .outputs = {"a(1)", "a(2)"},
                                             .band_hz = {0.01, 3},
                                             .accuracy = 1e-6});
    const SecondOrderModel m = r.second_order();
    REQUIRE(m.M.rows() == 2);
    CHECK((m.K.diagonal() - Eigen::Vector2d(9, 49)).norm() <= 1e-12 * 49);
    CHECK(std::abs(m.D.trace() - Z.trace()) <= 1e-12);
    CHECK(std::abs(m.D.determinant() - Z.determinant()) <= 1e-12);
    for (const std::complex<double> s : {std::complex<double>(0.1, 2), {0.01, 5}, {1, 40}}) {
      Eigen::Matrix2cd S = s * Z.cast<std::complex<double>>();
      S.diagonal() += Eigen::Vector2cd(s * s + 9.0, s * s + 49.0);
      const MatrixXcd right = s * s * kShapes * S.inverse() * kShapes.transpose();
      CHECK((r.transfer(s) - right).norm() <= 1e-9 * right.norm());
    }
  }
}
