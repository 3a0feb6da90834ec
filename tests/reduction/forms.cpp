#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>

#include "scenes.hpp"
#include "support/close.hpp"

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

namespace {

const titop::Scene question{.band_hz = {0, 40}, .accuracy = 1e-4};

/// Two beams, clamped; force at the tip, motion there as output.
Diagram boom(double xi) {
  Diagram d{"boom"};
  auto U = d.input("U", 6);
  auto b1 = d.add("b1", slim_beam(6, xi)), b2 = d.add("b2", slim_beam(6, xi));
  b1.parent.accel = 0;
  mount(b2, b1.child("C"), Rotation::about({1, 2, 3}, 0.7));
  auto tip = b2.child("C");
  tip.force = U;
  d.output("x", 6) = tip.position;
  d.output("v", 6) = tip.rate;
  d.output("a", 6) = tip.accel;
  return d;
}

double smallest_eigenvalue(const MatrixXcd& hermitian) {
  return Eigen::SelfAdjointEigenSolver<MatrixXcd>(hermitian, Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

}  // namespace

TEST_CASE("dense, second-order and modal exports are one model") {
  for (const double xi : {0.0, 0.01}) {
    const ReducedSystem r = compile(boom(xi), question);
    const StateSpace dense = r.state_space();
    const SecondOrderModel second = r.second_order();
    const ModalModel modal = r.modal();
    CHECK(dense.order() == r.order());
    CHECK(modal.order() == r.order());
    CHECK(2 * second.M.rows() == r.order());
    CHECK(dense.inputs == r.full().inputs());
    CHECK(dense.outputs == r.full().outputs());
    for (const Complex s : {Complex(0.3, 11), Complex(2, 140), Complex(40, 0)}) {
      const MatrixXcd H = r.transfer(s);
      CHECK(matrix_error(dense.transfer(s), H) <= 1e-9);
      CHECK(matrix_error(second.transfer(s), H) <= 1e-9);
      CHECK(matrix_error(modal.transfer(s), H) <= 1e-9);
    }
  }
}

TEST_CASE("the structure is kept: M = I, D and K semidefinite, undamped poles on the axis") {
  for (const double xi : {0.0, 0.01}) {
    const ReducedSystem r = compile(boom(xi), question);
    const SecondOrderModel m = r.second_order();
    CHECK(m.M == MatrixXd::Identity(m.M.rows(), m.M.rows()));
    CHECK(m.K == MatrixXd(m.K.diagonal().asDiagonal()));
    CHECK(m.K.diagonal().minCoeff() > 0);
    CHECK((m.D - m.D.transpose()).norm() <= 1e-12 * m.D.norm());
    if (xi == 0) {
      CHECK(m.D.isZero(0));
      for (const Pole& p : poles(r.state_space())) CHECK(p.s.real() == 0);
    } else {
      CHECK(smallest_eigenvalue(m.D.cast<Complex>()) > 0);
      for (const Pole& p : poles(r.state_space())) CHECK(p.s.real() < 0);
    }
  }
}

TEST_CASE("passive stays passive: force to rate at one point, in the band and far beyond it") {
  for (const double xi : {0.0, 0.01}) {
    const ReducedSystem r = compile(boom(xi), question);
    for (const double w : {0.1, 3.0, 30.0, 250.0, 3e3, 1e5}) {
      const MatrixXcd Y = r.transfer({0.001 * w, w}).middleRows(6, 6);
      const MatrixXcd twice = Y + Y.adjoint();
      CHECK(smallest_eigenvalue(twice) >= -1e-9 * twice.norm());
      // Reciprocal: far below the band to four digits more than the required accuracy, 1e-4.
      CHECK(matrix_error(Y, MatrixXcd(Y.transpose())) <= (w < 1 ? 1e-8 : 1e-9));
    }
  }
}

TEST_CASE("static gain is the full system's, without elastic states where nothing else is asked") {
  titop::Scene scene = question;
  scene.band_hz = {0, 0};
  scene.outputs = {"x"};
  const Diagram d = boom(0);
  const ReducedSystem r = compile(d, scene);
  CHECK(r.order() == 0);
  const MatrixXd gain = compile(d).static_gain().topRows(6);
  CHECK(matrix_error(r.state_space().D, gain) <= 1e-9);
  const ReducedSystem more = compile(d, question);
  CHECK(matrix_error(MatrixXd(more.transfer(0).real().topRows(6)), gain) <= 1e-9);
}

TEST_CASE("a scene chooses among inputs and outputs by name, and single scalars") {
  titop::Scene scene = question;
  scene.inputs = {"U(3)"};
  scene.outputs = {"a(3)", "x"};
  const Diagram d = boom(0);
  const ReducedSystem r = compile(d, scene);
  CHECK(r.inputs() == std::vector<std::string>{"U(3)"});
  CHECK(r.outputs() ==
        std::vector<std::string>{"x(1)", "x(2)", "x(3)", "x(4)", "x(5)", "x(6)", "a(3)"});
  const Complex s{0.2, 33};
  const MatrixXcd H = compile(d).transfer(s);
  CHECK(matrix_error(r.full().transfer(s).topRows(6), H.col(2).topRows(6)) <= 1e-12);
  CHECK(relative(r.full().transfer(s)(6, 0), H(14, 2)) <= 1e-12);
  scene.inputs = {"U"};
  CHECK(compile(d, scene).order() >= r.order());
}
