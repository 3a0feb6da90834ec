#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "held.hpp"
#include "scenes.hpp"
#include "support/alone.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// Structures given as an Lti of modal blocks: reduced as structures, and in loops by their modes.
using namespace titop;
using namespace titop_test;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

namespace {

enum class Form {
  frequency,  ///< [0 w; -w -2 xi w]
  companion,  ///< [0 1; -w^2 -2 xi w]
  real,       ///< [re im; -im re]
  any         ///< similar to these, states in random order
};

/// Modes from 1 Hz on, every 0.5 Hz with a random gap; forces on two points, displacement of both
/// and the rate of the first.
struct Modes {
  VectorXd omega;
  double xi = 0.005;
  MatrixXd shape;  ///< modes x 2

  explicit Modes(Index count) : omega(count), shape(count, 2) {
    Rng rng(47);
    for (Index i = 0; i < count; ++i)
      omega(i) = 2 * std::numbers::pi * (1 + 0.5 * double(i) + rng.between(0, 0.3));
    shape = rng.matrix(count, 2);
  }
  MatrixXcd transfer(Complex s) const {
    MatrixXcd H = MatrixXcd::Zero(3, 2);
    for (Index i = 0; i < omega.size(); ++i) {
      const double w = omega(i);
      const MatrixXd residue = shape.row(i).transpose() * shape.row(i);
      const Complex gain = 1.0 / (s * s + 2 * xi * w * s + w * w);
      H.topRows(2) += gain * residue;
      H.row(2) += s * gain * residue.row(0);
    }
    return H;
  }
  Truth truth() const {
    return {[this](Complex s) { return transfer(s); }, poles()};
  }
  std::vector<double> poles() const { return {omega.begin(), omega.end()}; }

  /// The same transfer.
  Lti lti(Form form) const {
    const Index n = 2 * omega.size();
    Lti m{MatrixXd::Zero(n, n), MatrixXd::Zero(n, 2), MatrixXd::Zero(3, n), MatrixXd::Zero(3, 2)};
    Rng rng(11);
    for (Index i = 0; i < omega.size(); ++i) {
      const double w = omega(i), re = -xi * w, im = w * std::sqrt(1 - xi * xi);
      Eigen::Matrix2d T;  // states from q and q'
      if (form == Form::frequency) T << w, 0, 0, 1;
      if (form == Form::companion) T.setIdentity();
      if (form == Form::real) T << im, 0, -re, 1;
      if (form == Form::any) T << 1, rng.between(-1, 1) / w, rng.between(-w, w), 3;
      const Eigen::Matrix2d A{{0, 1}, {-w * w, -2 * xi * w}}, back = T.inverse();
      const auto two = Eigen::seqN(2 * i, 2);
      m.A(two, two) = T * A * back;
      if (form == Form::frequency) m.A(two, two) << 0, w, -w, -2 * xi * w;
      m.B(two, Eigen::all) = T.col(1) * shape.row(i);
      m.C(Eigen::seqN(0, 2), two) = shape.row(i).transpose() * back.row(0);
      m.C(2, two) = shape(i, 0) * back.row(1);
    }
    if (form == Form::any) {
      std::vector<int> order(static_cast<std::size_t>(n));
      std::iota(order.begin(), order.end(), 0);
      rng.shuffle(order);
      m.A = m.A(order, order).eval();
      m.B = m.B(order, Eigen::all).eval();
      m.C = m.C(Eigen::all, order).eval();
    }
    return m;
  }
};

/// A law from the displacement of the first point to the force there: gain (1 + s / 20) / (1 + s /
/// 200), with the sign of a damper; and its disturbance.
constexpr double kGain = 30;
Diagram with_law(const Lti& lti) {
  Diagram d{"modal"};
  auto U = d.input("U");
  auto k = d.add("structure", lti);
  auto law = d.add(
      "law", Lti{.A = one(-200), .B = one(1), .C = one(-9 * 200 * kGain), .D = one(10 * kGain)});
  const MatrixXd first = MatrixXd::Identity(2, 1), read = MatrixXd::Identity(1, 3);
  law.in = read * k.out;
  k.in = first * (U - law.out);
  d.output("y", 3) = k.out;
  return d;
}
MatrixXcd closed(const Modes& m, Complex s) {
  const Eigen::VectorXcd open = m.transfer(s).col(0);
  return open / (1.0 + kGain * (1.0 + s / 20.0) / (1.0 + s / 200.0) * open(0));
}

}  // namespace

TEST_CASE("modal blocks: a structure in any form, with bounds that are theorems") {
  const Modes modes(24);
  const titop::Scene scene{.band_hz = {0, 5}, .accuracy = 1e-3, .bound = BoundKind::theorem};
  const int expected = compile(alone(modes.lti(Form::companion)), scene).order();
  for (const Form form : {Form::frequency, Form::companion, Form::real, Form::any}) {
    CAPTURE(static_cast<int>(form));
    const ReducedSystem r = compile(alone(modes.lti(form)), scene);
    CHECK(r.full().order() == 48);
    CHECK(std::abs(r.order() - expected) <= 2);
    CHECK(r.order() <= 32);
    CHECK(r.second_order().K.diagonal().minCoeff() > 0);
    check_beside(r, scene, modes.truth());
    CHECK(rightmost(r.state_space()) < 0);
  }
}

TEST_CASE("modal blocks: 706 of them, 1,412 states") {
  const Modes modes(706);
  const titop::Scene scene{.inputs = {"u(1)"}, .band_hz = {0, 2}, .accuracy = 1e-2};
  const ReducedSystem r = compile(alone(modes.lti(Form::frequency)), scene);
  CHECK(r.full().order() == 1412);
  CHECK(step(r, "whole").before == 706);
  CHECK(r.order() <= 30);
  CHECK(r.second_order().M.rows() * 2 == r.order());
  const Truth truth{[&](Complex s) { return MatrixXcd(modes.transfer(s).leftCols(1)); },
                    modes.poles()};
  check_beside(r, scene, truth);
}

TEST_CASE("modal blocks with a rigid motion: positions have none of it at 0 Hz, rates keep it") {
  const Modes modes(12);
  Lti lti = modes.lti(Form::frequency);
  const Index n = lti.A.rows();
  lti.A.conservativeResizeLike(MatrixXd::Zero(n + 2, n + 2));
  lti.B.conservativeResizeLike(MatrixXd::Zero(n + 2, 2));
  lti.C.conservativeResizeLike(MatrixXd::Zero(3, n + 2));
  lti.A(n, n + 1) = 1;
  lti.B.row(n + 1) << 0.5, 0.25;
  lti.C(2, n + 1) = 0.5;
  const titop::Scene scene{.band_hz = {0.1, 4}, .accuracy = 1e-3};
  const ReducedSystem r = compile(alone(lti), scene);
  CHECK(r.second_order().K(0, 0) == 0);
  const Truth truth{[&](Complex s) {
                      MatrixXcd H = modes.transfer(s);
                      H.row(2) += 0.5 / s * Eigen::RowVector2cd(0.5, 0.25);
                      return H;
                    },
                    modes.poles()};
  check_beside(r, scene, truth);
  CHECK(says(error_of([&] {
               compile(alone(lti), titop::Scene{.band_hz = {0, 4}});
             }),
             Code::bad_value, {"y(3)"}));
}

TEST_CASE("modal blocks in a loop lose modes first if there are too many states") {
  const Modes modes(60);
  for (const Form form : {Form::frequency, Form::any}) {
    const Diagram d = with_law(modes.lti(form));
    titop::Scene scene{.band_hz = {0, 3}, .accuracy = 1e-2, .balance_up_to = 80};
    const ReducedSystem r = compile(d, scene);
    CHECK(r.full().order() == 121);
    CHECK(step(r, "bodies").error <= 3e-3);
    CHECK(step(r, "kept").before <= 80);
    CHECK(r.order() <= 40);
    check_beside(r, scene, with_poles(r, [&](Complex s) { return closed(modes, s); }));
    CHECK(rightmost(r.state_space()) < 0);
    scene.balance_up_to = 4;
    CHECK(says(error_of([&] { compile(d, scene); }), Code::bad_value,
               {"balance_up_to = 4", "structure"}));
  }
}

TEST_CASE(
    "a modal block that inputs move in two directions is no structure, and reduced as states") {
  const Modes modes(6);
  Lti lti = modes.lti(Form::real);
  lti.B(6, 1) += 0.5;  // of the fourth mode
  const titop::Scene scene{.band_hz = {0, 3}, .accuracy = 1e-2};
  const ReducedSystem r = compile(alone(lti), scene);
  CHECK(says(error_of([&] { r.second_order(); }), Code::bad_value, {"k.x7"}));
  const auto exact = [&](Complex s) {
    const MatrixXcd K = s * MatrixXcd::Identity(12, 12) - lti.A;
    return MatrixXcd(lti.C * K.fullPivLu().solve(MatrixXcd(lti.B.cast<Complex>())));
  };
  check_beside(r, scene, with_poles(r, exact));
}

TEST_CASE("an overdamped block among modal blocks is a coordinate like the others") {
  Modes modes(6);
  Lti lti = modes.lti(Form::frequency);
  const double w = modes.omega(2);
  lti.A(5, 5) = -2 * 1.2 * w;
  const titop::Scene scene{.band_hz = {0, 10}, .accuracy = 1e-9};
  const ReducedSystem r = compile(alone(lti), scene);
  CHECK(r.second_order().M.rows() == 6);
  for (const Complex s : {Complex(0, 1), Complex(0.1, 2 * w), Complex(0, 30)}) {
    const MatrixXcd K = s * MatrixXcd::Identity(12, 12) - lti.A;
    const MatrixXcd exact = lti.C * K.fullPivLu().solve(MatrixXcd(lti.B.cast<Complex>()));
    CHECK((r.transfer(s) - exact).cwiseAbs().maxCoeff() <= 1e-10 * exact.cwiseAbs().maxCoeff());
  }
}
