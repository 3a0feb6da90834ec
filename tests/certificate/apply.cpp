#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "../../examples/scenes/two_link_arm.hpp"
#include "../support/half_ties.hpp"
#include "../support/notes.hpp"

/// apply against the transfer, by the default certificate: the scenes in which rates or positions
/// are integrated, and states follow from others.

using namespace titop;

TEST_CASE("states that follow from others: apply and the transfer agree") {
  const Certificate c = compile(half_ties::turned()).certificate();
  CHECK_FALSE(c.at_instant);
  CHECK(c.apply_against_transfer == 0);
}

TEST_CASE("a motion that a closed chain prevents and an equation prescribes is warned of") {
  const Rotation I = Rotation::about({0, 0, 1}, 0.0);
  Diagram d{"locked"};
  auto u = d.input("u");
  auto base = d.add("base", RigidBody{.children = {{"A", {0, 0, 0}}, {"B", {1, 0, 0}}}});
  ModalData data;  // two bending modes that move the tip, none along the mast
  data.omega = Eigen::VectorXd{{10, 20}};
  data.xi = Eigen::VectorXd::Zero(2);
  data.L_P = Eigen::MatrixXd{{0, 1, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0}};
  data.D_P = 9 * Matrix6::Identity();
  data.children = {
      {"tip", {1, 0, 0}, Eigen::MatrixXd{{0, 0}, {1, 0}, {0, 1}, {0, 0}, {0, 0}, {0, 0}}}};
  auto mast = d.add("mast", FlexibleBody{data});
  base.parent.accel = 0;
  auto jack = slide(d, "jack", mast, base.child("A"), I, {1, 0, 0});
  weld(mast.child("tip"), base.child("B"), I);
  jack.accel = u;
  d.output("x") = jack.travel;
  const System system = compile(d);
  CHECK(system.certificate().apply_against_transfer > 0.5);
  CHECK(titop_test::noted(system, Note::Kind::warning, "certify", {"jack.rate"}));
}

TEST_CASE("apply agrees at outputs that far above all of the band are 1e-15 of the inputs'") {
  // The certificate's s is 2e6 and 5e6 rad/s, where the hub does not move the hand.
  for (const int elements : {20, 24}) {
    const System system = compile(scenes::two_link_arm::arm_of(elements), {.minimize_up_to = 0});
    CHECK(system.certificate().apply_against_transfer == 0);
    CHECK_FALSE(titop_test::noted(system, Note::Kind::warning, "certify"));
  }
}
