// Scenes with ExactBeam: transfers in every precision, parts of a beam, refused results, files.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <vector>

#include "blocks/exact_beams.hpp"
#include "support/beam_by_hand.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"

using namespace exact_beams;
using namespace titop;
using Eigen::MatrixXcd;
using titop_test::error_of;
using titop_test::says;

namespace {

/// A free chain of equal parts, driven and seen at both ends.
Diagram chain(ExactBeam beam, int parts) {
  Diagram d{"chain"};
  beam.length /= parts;
  std::vector<BodyHandle> all;
  for (int i = 0; i < parts; ++i) {
    all.push_back(d.add("b" + std::to_string(i + 1), beam));
    if (i > 0) mount(all[static_cast<std::size_t>(i)], all[static_cast<std::size_t>(i - 1)].child);
  }
  all.front().parent.force = -d.input("F_P", 6);
  all.back().child.force = d.input("F_C", 6);
  d.output("a_P", 6) = all.front().parent.accel;
  d.output("a_C", 6) = all.back().child.accel;
  return d;
}

/// An arm of two exact links and a finite one, with a hinge and a spring, on a free hub.
Diagram arm() {
  Diagram d{"arm"};
  auto hub = d.add("hub", RigidBody{.mass = 20,
                                    .inertia = Vector3d(2, 3, 4).asDiagonal(),
                                    .children = {{"arm", {0.3, 0.1, 0}}}});
  auto upper = d.add("upper", boom({.mass = 0.1, .stiffness = 1e-5}));
  auto lower = d.add("lower", boom());
  auto hand = d.add("hand", FlexibleBody{with_elements(boom(), 4)});
  hub.parent.force = -d.input("F", 6);
  mount(upper, hub.child("arm"), Rotation::about(kZ, 0.4));
  auto elbow = hinge(d, "elbow", lower, upper.child, Rotation::about(kZ, -0.9), kZ);
  elbow.torque = -40 * elbow.angle - 0.3 * elbow.rate + d.input("T");
  mount(hand, lower.child, Rotation::about(kX, 0.2));
  d.output("a", 6) = hub.parent.accel;
  d.output("hand", 6) = hand.child.accel;
  d.output("angle") = elbow.angle;
  return d;
}

}  // namespace

TEST_CASE("two halves, and five fifths, are the whole at any frequency") {
  for (const fe::Rayleigh& law : {fe::Rayleigh{}, fe::Rayleigh{.stiffness = 1e-5}}) {
    const ExactBeam b = boom(law);
    const System whole = compile(chain(b, 1));
    for (const int parts : {2, 5}) {
      const System cut = compile(chain(b, parts));
      for (const double beta_L : {1e-3, 0.1, 0.7, 1.3, 3.0, 11.0, 37.0, 110.0})
        for (const double angle : {0.0, 0.9, 1.54}) {
          const Complex s = std::polar(omega_at(b, beta_L), angle);
          INFO(parts << ' ' << beta_L << ' ' << angle);
          CHECK(titop_test::matrix_error(cut.transfer(s), whole.transfer(s)) <= 1e-12);
        }
    }
  }
}

TEST_CASE("a scene's transfers in every precision, against all its equations at once") {
  const Diagram d = arm();
  const System system = compile(d);
  for (const Complex s : {Complex(0.3, 0), Complex(0.02, 2), Complex(1, 90), Complex(0, 3000)}) {
    const MatrixXcd exact = system.transfer(s, Precision::digits50);
    CHECK(titop_test::matrix_error(system.transfer(s), exact) <= 1e-12);
    CHECK(titop_test::matrix_error(system.transfer(s, Precision::refined), exact) <= 1e-12);
    CHECK(titop_test::matrix_error(system.transfer(s, Precision::twofold), exact) <= 1e-12);
    CHECK(titop_test::matrix_error(transfer(d.graph(), s), exact) <= 1e-9);
  }
  CHECK(system.frequency_response(std::vector{2.0, 90.0})[1] == system.transfer({0, 90}));
  CHECK(system.certificate().residual >= 0);
  CHECK(system.certificate().residual <= 1e-12);
  CHECK(system.certificate().apply_against_transfer < 0);
  CHECK(titop_test::noted(system, Note::Kind::warning, "check", {"upper"}));
  CHECK(titop_test::noted(system, Note::Kind::warning, "check", {"lower"}));
}

TEST_CASE("results that need a state space are refused and name the blocks") {
  const Diagram d = arm();
  const System system = compile(d);
  const auto refused = [](auto f) {
    const Error error = error_of(f);
    return says(error, Code::not_rational, {"upper", "with_elements"}) &&
           says(error, Code::not_rational, {"lower", "FlexibleBody"});
  };
  CHECK(refused([&] { system.state_space(); }));
  CHECK(refused([&] { system.poles(); }));
  CHECK(refused([&] { system.descriptor(); }));
  CHECK(refused([&] { system.order_verdict(); }));
  CHECK(refused([&] { system.dense_certificate(); }));
  CHECK(refused([&] {
    StateSpace model, *to = &model;
    system.write(*to);
  }));
  CHECK(refused(
      [&] { system.apply(Eigen::VectorXd::Zero(system.order()), Eigen::VectorXd::Zero(7)); }));
  CHECK(refused([&] { certify(system); }));
  CHECK(refused([&] { lft(system, {}); }));
  CHECK(refused([&] {
    simulate(system, Excitation::step(Eigen::VectorXd::Ones(7)), {.step = 0.1, .until = 1});
  }));
  CHECK(refused([&] { compile(d, Scene{.band_hz = {0.1, 10}}); }));
  CHECK(says(error_of([&] { model_of(as_block(boom())); }), Code::not_rational, {"ExactBeam"}));
}

TEST_CASE("a beam fixed at both ends: its forces, as of the boundary value problem") {
  Diagram d{"fixed"};
  auto b = d.add("b", boom());
  b.parent.accel = d.input("a", 6);
  b.child.accel = 0;
  d.output("F", 6) = b.child.force;
  const Complex s(1, 60);
  const MatrixXcd Y = titop_test::beam_by_hand(boom(), s);
  const MatrixXcd expected = -Y.topLeftCorner(6, 6).inverse() * Y.topRightCorner(6, 6);
  CHECK(titop_test::matrix_error(compile(d).transfer(s), expected) <= 1e-12);
}

TEST_CASE("a diagram file has it, to the last bit") {
  const std::string text = diagram_json(arm());
  const Diagram again = parse_diagram(text);
  CHECK(diagram_json(again) == text);
  const Complex s(0.1, 30);
  CHECK(compile(again).transfer(s) == compile(arm()).transfer(s));
}
