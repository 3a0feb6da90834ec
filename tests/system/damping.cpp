// Modes of an assembly that are damped otherwise than the bodies' clamped modes are told of, in the
// log and in the table of poles.
#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "support/notes.hpp"

using namespace titop;
using namespace titop_test;

namespace {

/// A boom of one mode along y: its mass at P, all of it but the rest of 1 kg; the tip moves by phi
/// per modal coordinate.
FlexibleBody boom(double xi, double phi, double modal_mass = 1) {
  ModalData data;
  data.omega = Eigen::VectorXd::Constant(1, 10);
  data.xi = Eigen::VectorXd::Constant(1, xi);
  data.L_P = std::sqrt(modal_mass) * Eigen::RowVectorXd::Unit(6, 1);
  const double m = modal_mass + 1;
  data.D_P = Vector6(m, m, m, m, m, m).asDiagonal();
  data.children = {{"C", {0, 0, 0}, Vector6::Unit(1) * phi}};
  return {data};
}

/// The boom clamped, 12 kg on its tip, which has modal mass `ratio` then.
struct WithTip {
  Diagram d{"with tip"};
  BodyHandle body, tip;
  WithTip(double xi, double ratio)
      : body(d.add("boom", boom(xi, std::sqrt((ratio - 1) / 12)))),
        tip(d.add("tip", RigidBody{.mass = 12, .children = {{"C"}}})) {
    body.parent.accel = 0;
    mount(tip, body.child("C"));
    tip.child("C").force += d.input("F", 6);
    d.output("y", 6) = tip.child("C").accel;
  }
};

/// Number of notes with this damping ratio of bodies.
int told(const System& system, std::string_view xi) {
  return count_notes(system.dense_notes(), Note::Kind::info, "dense", {"damping_of_assembly", xi});
}

bool in_table(const System& system, std::string_view xi) {
  return has_name(to_string(system.poles()), xi);
}

}  // namespace

TEST_CASE("a mode of less than a fifth of its body's damping is told of, one of a quarter is not") {
  const System less = compile(WithTip(0.003, 36).d);  // a sixth, at 10 / 6 rad/s
  CHECK(told(less, "0.003") == 1);
  CHECK(count_notes(less.dense_notes(), Note::Kind::info, "dense", {"1.667", "0.0005"}) == 1);
  CHECK(in_table(less, "xi 0.003"));
  const System quarter = compile(WithTip(0.003, 16).d);
  CHECK(told(quarter, "0.003") == 0);
  CHECK(!in_table(quarter, "xi"));
  CHECK(told(compile(WithTip(0, 36).d), "0") == 0);
}

TEST_CASE("a mode of more than five times its body's damping, unless something else damps it") {
  // Free at P, of 49 kg 48 in the mode: omega and xi times sqrt(49).
  Diagram d{"free"};
  auto body = d.add("boom", boom(0.002, 1, 48));
  body.parent.force = -d.input("F", 6);
  d.output("y", 6) = body.parent.accel;
  const System more = compile(d);
  REQUIRE(more.poles().size() == 1);
  CHECK(std::abs(more.poles()[0].damping - 0.014) <= 1e-12);
  CHECK(told(more, "0.002") == 1);
  CHECK(in_table(more, "xi 0.002"));

  WithTip damped(0.003, 2);
  damped.tip.child("C").force +=
      Eigen::MatrixXd(-60 * Matrix6::Identity()) * damped.tip.child("C").rate;
  const System by_damper = compile(damped.d);
  REQUIRE(by_damper.poles().size() >= 1);
  CHECK(by_damper.poles()[0].damping > 5 * 0.003);
  CHECK(told(by_damper, "0.003") == 0);
  CHECK(!in_table(by_damper, "xi"));
}

TEST_CASE("a mode of two bodies: above five times the larger damping ratio, not the smaller one") {
  // On a hub without mass both bend alike, free, of 98 kg 96 in the mode: 10 sqrt(49) rad/s, and xi
  // is sqrt(49) times the mean of both.
  const auto two_booms = [](double first, double second) {
    Diagram d{"two booms"};
    auto hub = d.add("hub", RigidBody{.mass = 0, .children = {{"1"}, {"2"}}});
    mount(d.add("a", boom(first, 1, 48)), hub.child("1"));
    mount(d.add("b", boom(second, 1, 48)), hub.child("2"));
    hub.parent.force = -d.input("F", 6);
    d.output("y", 6) = hub.parent.accel;
    return compile(d);
  };
  const System near = two_booms(0.002, 0.003), far = two_booms(0.002, 0.01);
  REQUIRE(!near.poles().empty());
  CHECK(std::abs(near.poles().back().omega - 70) <= 1e-3);
  CHECK(std::abs(near.poles().back().damping - 7 * 0.0025) <= 1e-4);  // 0.0175 > 5 * 0.003
  CHECK(told(near, "0.002 to 0.003") == 1);
  CHECK(in_table(near, "xi 0.002 to 0.003"));
  CHECK(std::abs(far.poles().back().damping - 7 * 0.006) <= 1e-3);  // 0.042 < 5 * 0.01
  CHECK(told(far, "0.002 to 0.01") == 0);
  CHECK(!in_table(far, "xi"));
}
