#include "support/questions.hpp"

#include <fmt/format.h>

#include "generate/diagrams/modes.hpp"
#include "scenes/frame.hpp"
#include "scenes/satellite.hpp"

namespace titop_bench {
namespace {

using namespace titop;
using Eigen::MatrixXd;
using scenes::frame;

/// Its tip carries 50 times its mass.
Diagram heavy(const FlexibleBody& beam) {
  Diagram d{"heavy"};
  const double m = 50 * beam.data().D_P(0, 0);
  auto U = d.input("U", 6);
  auto b = d.add("beam", beam);
  auto tip = d.add("tip", RigidBody{.mass = m, .inertia = Matrix3d::Identity() * 0.01 * m});
  b.parent.accel = 0;
  mount(tip, b.child("C"), Rotation{});
  b.child("C").force += U;
  d.output("a", 6) = tip.parent.accel;
  return d;
}

/// The hub of the satellite and two booms, its attitude held by a law with an actuator and a delay:
/// no structure, so states are balanced.
Diagram loop(const FlexibleBody& beam) {
  const MatrixXd I = MatrixXd::Identity(3, 3);
  Diagram d{"loop"};
  auto T = d.input("T", 3);
  auto hub = d.add("hub", RigidBody{.mass = 85,
                                    .inertia = Vector3d(9, 11, 13).asDiagonal(),
                                    .children = {{"C1", {0.35, 0, 0.1}}, {"C2", {-0.35, 0, 0.1}}}});
  auto boom1 = d.add("boom1", beam), boom2 = d.add("boom2", beam);
  auto law =
      d.add("law", Lti{.A = -40 * I, .B = I, .C = (30 - 45 * 40) * 40 * I, .D = 45 * 40 * I});
  auto late = d.add("late", Lti{.A = -100 * I, .B = I, .C = 200 * I, .D = -I});
  mount(boom1, hub.child("C1"), Rotation::about({0, 0, 1}, 0.26));
  mount(boom2, hub.child("C2"), Rotation::about({1, 2, 9}, 2.9));
  law.in = hub.parent.position.angular();
  late.in = law.out;
  hub.parent.force.linear = 0;
  hub.parent.force.angular = late.out - T;
  d.output("attitude", 3) = hub.parent.position.angular();
  d.output("tip", 3) = boom2.child("C").accel.linear;
  return d;
}

Diagram generated(const FlexibleBody& structure) {
  Diagram d{"generated"};
  auto U = d.input("U", 3);
  auto body = d.add("body", structure);
  body.parent.accel = 0;
  body.child("C1").force.linear = U;
  d.output("a1", 3) = body.child("C1").accel.linear;
  d.output("v2", 3) = body.child("C2").rate.linear();
  return d;
}

Diagram satellite(const FlexibleBody& boom) { return scenes::satellite(boom); }

}  // namespace

std::vector<Question> questions(bool quick) {
  fe::ModeOptions modes;  // all 342
  if (quick) modes.kept = 12;
  const FlexibleBody undamped = scenes::read_boom(modes);
  modes.xi = {0.005};
  const FlexibleBody damped = scenes::read_boom(modes),
                     many = titop::generate::clustered_modes(
                         {.modes = quick ? 40 : 500, .points = 3, .width = 0.04, .carried = true});
  std::vector<Question> all;
  const auto ask = [&](Diagram (*build)(const FlexibleBody&), const FlexibleBody& body,
                       double band_hz, bool structure = true) {
    all.push_back({build(body).name(), {.band_hz = {0, band_hz}}, structure, [=](double hertz) {
                     return build(FlexibleBody(scenes::up_to(body.data(), hertz)));
                   }});
  };
  ask(frame, undamped, 261);
  ask(heavy, undamped, 261);
  ask(satellite, damped, 300);
  ask(generated, many, 5);
  ask(loop, damped, 100, false);
  return all;
}

Diagram zigzag(const FlexibleBody& beam, int count) {
  Diagram d{"zigzag"};
  auto U = d.input("U", 6);
  std::vector<BodyHandle> b;
  for (int i = 0; i < count; ++i) {
    b.push_back(d.add(fmt::format("b{}", i + 1), beam));
    const Rotation turn = Rotation::about({1, 2, 3}, i % 2 ? 0.7 : -0.9);
    if (i > 0) mount(b.back(), b[b.size() - 2].child("C"), turn);
  }
  b.front().parent.accel = 0;
  b.back().child("C").force = U;
  d.output("a", 6) = b.back().child("C").accel;
  return d;
}

}  // namespace titop_bench
