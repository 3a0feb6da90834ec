// Rayleigh damping of a mesh: of each clamped mode, and against alpha M + beta K by hand.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "scenes/by_hand.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;
using namespace scenes_test;

namespace {

constexpr double kAlpha = 1.7, kBeta = 3e-5;  // [1/s], [s]
const Tube kTube{1.3, 0.05, 0.045, 2};

Beam beam(const fe::ModeOptions& modes) {
  Beam result = kTube.beam();
  result.modes = modes;
  return result;
}

}  // namespace

TEST_CASE("each clamped mode and residual vector has (alpha / w + beta w) / 2") {
  const ModalData data =
      modal_data(beam({.kept = 5, .residual = {"C"}, .rayleigh = fe::Rayleigh{kAlpha, kBeta}}));
  REQUIRE(data.omega.size() > 5);
  for (Index i = 0; i < data.omega.size(); ++i)
    CHECK(std::abs(data.xi(i) - (kAlpha / data.omega(i) + kBeta * data.omega(i)) / 2) <=
          1e-14 * data.xi(i));
}

TEST_CASE("the clamped beam has the transfer of alpha M + beta K") {
  const by_hand::FreeBeam fe = by_hand::free_beam(kTube.numbers());
  const Index n = 6 * kTube.elements;
  by_hand::Structure a = by_hand::empty(n, 6, 6);
  a.M = fe.M.bottomRightCorner(n, n);
  a.K = fe.K.bottomRightCorner(n, n);
  a.D = kAlpha * a.M + kBeta * a.K;
  a.C.rightCols(6).setIdentity();
  a.B = a.C.transpose();
  Diagram d{"clamped"};
  auto boom = d.add("boom", FlexibleBody{beam({.rayleigh = fe::Rayleigh{kAlpha, kBeta}})});
  boom.parent.accel = 0;
  boom.child.force = d.input("F", 6);
  d.output("C", 6) = boom.child.accel;
  const System system = compile(d);
  const std::vector<Complex> s = points({50, 300, 2000, 20000});
  std::vector<MatrixXcd> exact;
  for (const Complex z : s) exact.push_back(by_hand::accel_transfer(a, z));
  CHECK(error_3(responses(system, s), exact) <= 1e-10);
  CHECK(by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(a)) <= 1e-10);
}

TEST_CASE("Rayleigh damping that is negative, not finite or beside xi") {
  const auto refused = [](const fe::ModeOptions& modes) {
    return error_of([&] { modal_data(beam(modes)); });
  };
  CHECK(says(refused({.rayleigh = fe::Rayleigh{-1, 0}}), Code::bad_value, {"mass", "-1"}));
  CHECK(says(refused({.rayleigh = fe::Rayleigh{0, -2}}), Code::bad_value, {"stiffness", "-2"}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(says(refused({.rayleigh = fe::Rayleigh{nan, 0}}), Code::bad_value, {"mass", "nan"}));
  CHECK(says(refused({.xi = {0.01}, .rayleigh = fe::Rayleigh{1, 0}}), Code::bad_value, {}));
}
