#include <doctest/doctest.h>

#include "against.hpp"
#include "generate/diagrams/modes.hpp"

/// Lightly damped modes in clusters with few small terms, compared with the sum over modes written
/// out.
using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

namespace {

/// Force at the first point; acceleration there and rate at the second one.
Diagram structure(const ModalData& data) {
  Diagram d{"generated"};
  auto U = d.input("U", 2);
  auto body = d.add("body", FlexibleBody(data));
  body.parent.accel = 0;
  MatrixXd two = MatrixXd::Zero(6, 2);
  two.topRows(2).setIdentity();
  body.child("C1").force = two * U;
  d.output("a1", 3) = body.child("C1").accel.linear;
  d.output("v2", 3) = body.child("C2").rate.linear();
  return d;
}

Truth sum_of_modes(const ModalData& m) {
  const MatrixXcd in = m.children[0].Phi_C.topRows(2).transpose().cast<Complex>(),
                  a1 = m.children[0].Phi_C.topRows(3).cast<Complex>(),
                  v2 = m.children[1].Phi_C.topRows(3).cast<Complex>();
  Truth truth{[=, omega = m.omega, xi = m.xi](Complex s) {
                MatrixXcd q = in;
                for (Eigen::Index j = 0; j < q.rows(); ++j)
                  q.row(j) /= s * s + 2 * xi(j) * omega(j) * s + omega(j) * omega(j);
                MatrixXcd H(6, 2);
                H << s * s * (a1 * q), s * (v2 * q);
                return H;
              },
              {}};
  truth.omegas.assign(m.omega.begin(), m.omega.end());
  return truth;
}

}  // namespace

TEST_CASE("120 clustered modes of damping 0.5 %: one nested sequence, errors below their bounds") {
  const ModalData data = generate::clustered_modes({.modes = 120});
  const Diagram d = structure(data);
  const Truth truth = sum_of_modes(data);
  titop::Scene scene{.band_hz = {0, 3}};
  const std::vector<double> accuracies{1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  const std::vector<WhatIf> table = what_if(d, scene, accuracies);
  REQUIRE(table.size() == accuracies.size());
  int before = 0;
  for (const WhatIf& w : table) {
    CAPTURE(w.accuracy);
    CHECK(w.order >= before);
    before = w.order;
    CHECK(w.bound <= w.accuracy);
    const Beside by_hand = beside(w.system, scene, truth);
    CHECK(by_hand.bound <= 1);
    CHECK(w.bound <= 1.2 * by_hand.error);
    CHECK(by_hand.peak_low >= 0.87);
    CHECK(by_hand.peak_high <= 1.001);
  }
  CHECK(before <= 240 / 2);  // 30 modes in the band, and not many vectors
  for (const Pole& p : poles(table.back().system.state_space())) CHECK(p.s.real() < 0);
}

TEST_CASE("the modes of the band that are kept are the structure's, with their damping") {
  const ModalData data = generate::clustered_modes({.modes = 60});
  const titop::Scene scene{.band_hz = {0, 3}, .accuracy = 1e-3};
  const ReducedSystem r = compile(structure(data), scene);
  int exact = 0;
  for (const KeptMode& m : r.modes()) {
    if (!m.exact) continue;
    ++exact;
    double nearest = 1;
    for (const double w : data.omega)
      nearest = std::min(nearest, std::abs(2 * std::numbers::pi * m.hertz / w - 1));
    CHECK(nearest <= 1e-12);
    CHECK(std::abs(m.damping / 0.005 - 1) <= 1e-9);
  }
  CHECK(exact >= 10);
}
