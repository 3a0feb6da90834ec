// Scenes written and read again: the same text, and the same model to the last bit.
#include <doctest/doctest.h>

#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/titop.hpp>

#include "generate/diagrams/random_diagram.hpp"
#include "support/close.hpp"
#include "support/five_masses.hpp"
#include "support/folder.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop::generate;
using namespace titop_test;

namespace {

/// A diagram with every kind of block, factor and reading.
Diagram everything() {
  Diagram d{"every \"kind\" of thing, κ"};
  const Param k = d.param("k", 1.0 / 3), angle = d.param("angle", 0.7);
  auto u = d.input("u"), W = d.input("W", 6);
  auto hub = d.add("hub", RigidBody{.mass = 90 * k,
                                    .inertia = Vector3d(9, 11, 13).asDiagonal(),
                                    .PA = {0.02, -0.01, 0.3 * k},
                                    .children = {{"C1", {k, 0, 0.1}},
                                                 {"W", {0, 0, 0.2}},
                                                 {"C2", {-0.3, 0, 0.1}},
                                                 {"C3", {0, 0.4, 0}},
                                                 {"C4", {0, -0.4, 0}}}});
  const FlexibleBody boom(Beam{.length = 1.7,
                               .section = tube(0.05, 0.045),
                               .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                               .elements = 1,
                               .modes = {.xi = {0.004}}});
  int axial = 0;  // a mode that has less mass with a smaller entry
  boom.data().L_P.col(0).cwiseAbs().maxCoeff(&axial);
  const FlexibleBody softer(boom, {.omega = {{1, 400 * k}},
                                   .xi = {{2, 0.03 * k}, {3, 0.1}},
                                   .L_P = {{axial + 1, 1, 1.5 * boom.data().L_P(axial, 0) * k}},
                                   .Phi_C = {{"C", {{1, 2, 0.02 * k}, {2, 6, 0.1}}}}});
  const Eigen::MatrixXd Z =
      Eigen::MatrixXd::Identity(6, 6) / 7 + Eigen::MatrixXd::Constant(6, 6, 0.03);
  auto b1 = d.add("b1", boom), b2 = d.add("b2", boom.damped_by(Z)), b3 = d.add("b3", softer);
  auto wheel = d.add("wheel", RigidBody{.mass = 4, .inertia = {1, 2 * k, 1, 0, 0.1 * k, 0}});
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = k, .damping = 0.1});
  auto K = d.add("K", Lti{.A = -Eigen::MatrixXd::Identity(1, 1) / 7,
                          .B = Eigen::MatrixXd::Identity(1, 1),
                          .C = Eigen::MatrixXd::Identity(1, 1),
                          .values = {{'A', 1, 1, -0.1 * k}, {'C', 1, 1, 3 * k}}});
  auto gain = d.add("gain", Gain{.gain = -2 * k});
  auto matrix = d.add("matrix", MatrixGain{Eigen::RowVector2d(0.1, 0.3)});
  auto sum = d.add("sum", Sum{.signs = "+-"});
  auto integral = d.add("integral", Integrator{});

  hub.parent.force = -W;
  const Rotation oblique = Rotation::about({1, 2, 9}, 2.9) * Rotation::about({0, 1, 0}, angle);
  auto h = hinge(d, "h", b1, hub.child("C1"), oblique, {0, 1, 3});
  h.torque = k * h.angle + 0.3 * h.rate - u;
  auto s = slide(d, "s", b2, hub.child("C2"), Rotation::about({0, 0, 1}, 0.1), {1, 0, 0});
  s.force = 40.0 * s.travel + K.out;
  auto j = joint(d, "j", b3, hub.child("C3"), {}, {about({1, 0, 0}, "roll"), about({0, 1, 1})});
  j.axis("roll").force = 5.0 * j.axis("roll").position;
  bushing(d, "iso", wheel, hub.child("C4"), {},
          {.stiffness = {300 * k, 100, 100, 10, 10, 10},
           .damping = SixAxes(Matrix6(0.1 * Matrix6::Identity())).with(1, 5, 0.03 * k)});
  mount(z, b1.child.along({0, 0.6, 0.8}));
  auto rotor = d.add("rotor", Rotor{.mass = 2 * k,
                                    .axial = 0.1 * k,
                                    .transverse = 0.2,
                                    .axis = {0, 1, 1},
                                    .momentum = 9 * k});
  mount(rotor, hub.child("W"), Rotation::about({1, 0, 0}, 0.2));
  rotor.torque = 0.1 * rotor.speed;
  K.in = d.loop_point("cut", gain.out);
  gain.in = h.angle;
  sum.in(1) = h.rate;
  sum.in(2) = matrix.out;
  matrix.in = Eigen::MatrixXd(Eigen::Vector2d(1, 2)) * s.travel;
  integral.in = sum.out;
  d.output("hub", 6) = hub.parent.accel;
  d.output("tilt", 3) = hub.parent.position.angular();
  d.output("held") = integral.out + z.stretch;
  d.output("reaction", 6) = b3.parent.reaction;
  d.output("nothing", 2) = 0;
  return d;
}

void check_round_trip(const Diagram& diagram) {
  const std::string text = diagram_json(diagram);
  const Diagram again = parse_diagram(text);
  CHECK(diagram_json(again) == text);
  const System a = compile(diagram), b = compile(again);
  CHECK(difference(a.state_space(), b.state_space()) == "");
  CHECK(a.log() == b.log());
  CHECK(a.dense_log() == b.dense_log());
  CHECK(b.parameters() == a.parameters());
}

}  // namespace

TEST_CASE("every kind of thing comes back to the last bit") {
  check_round_trip(everything());
  const System a = compile(everything()), b = compile(parse_diagram(diagram_json(everything())));
  const ParameterList other = {{"k", 0.5}, {"angle", -0.2}};
  CHECK(difference(a.update(other).state_space(), b.update(other).state_space()) == "");
}

TEST_CASE("shared modal data stand in the file once") {
  const std::string text = diagram_json(everything());
  CHECK(text.find("\"body1\": {") != std::string::npos);
  CHECK(text.find("body2") == std::string::npos);
}

TEST_CASE("scenes of the paper and random scenes come back to the last bit") {
  check_round_trip(five_masses_scene({1, 2, 3, 4, 5}, {10, 26, 33, 20, 95}));
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    INFO("seed ", seed);
    RandomOptions options = random_options(seed);
    options.incomplete = false;
    check_round_trip(random_diagram(options).build());
  }
}

TEST_CASE("a file is the text, in the order in which it was written") {
  const Folder folder;
  const Diagram d = five_masses_scene({1, 2, 3, 4, 5}, {10, 26, 33, 20, 95});
  write_diagram(d, folder.path / "masses.json");
  CHECK(folder.read("masses.json") == diagram_json(d));
  CHECK(diagram_json(read_diagram(folder.path / "masses.json")) == diagram_json(d));
  CHECK_THROWS_AS(write_diagram(d, folder.path / "none" / "masses.json"), Error);
  CHECK_THROWS_AS(read_diagram(folder.path / "none.json"), Error);
}

TEST_CASE("a rotor that nothing carries is refused after a round trip as before") {
  Diagram d{"rotor"};
  d.add("wheel", Rotor{.mass = 1, .axial = 0.1, .transverse = 0.06, .momentum = 5}).torque = 0;
  CHECK(error_of([&] { compile(d); }).has(Code::no_equation));
  CHECK(error_of([&] { compile(parse_diagram(diagram_json(d))); }).has(Code::no_equation));
}

TEST_CASE("scenes that cannot be written are refused") {
  Diagram twice{"twice"};
  twice.add("z", SpringMass{});
  twice.add("z", SpringMass{});
  twice.input("u", 0);
  try {
    diagram_json(twice);
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.has(Code::duplicate_name));
    CHECK(error.has(Code::size));
  }
}
