// Damping as test reports state it. A boom has xi = 0.3 % of its own modes, clamped at its root;
// with 12 kg on its tip the wing has much less. A test of the wing says 0.3 % up to 1 Hz and 0.5 %
// from 20 Hz on: `damping_of_assembly` makes a body of the wing in which each assembled mode has
// the damping of the report, clamped on the bench or, of the whole spacecraft, in orbit.
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

constexpr double kTipMass = 12;  // [kg]
const ModalDamping kReport{{1.0, 0.003}, {20.0, 0.005}};
const RigidBody kHub{
    .mass = 300, .inertia = Vector3d(80, 90, 100).asDiagonal(), .children = {{"W", {1, 0, 0}}}};

Beam boom_data() {
  return {.length = 5,
          .section = tube(0.05, 0.048),
          .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
          .modes = {.kept = 2, .residual = {"C"}, .xi = {0.003}}};
}

/// Boom and tip mass as blocks; returns the boom, by which they are mounted.
BodyHandle add_wing(Diagram& d) {
  auto boom = d.add("boom", FlexibleBody{boom_data()});
  auto tip = d.add(
      "tip", RigidBody{.mass = kTipMass, .inertia = Matrix3d::Identity(), .children = {{"C"}}});
  mount(tip, boom.child("C"));
  return boom;
}

/// The same as one body, tested on a bench.
FlexibleBody wing() {
  Diagram part{"wing"};
  add_wing(part);
  return damping_of_assembly(part, "boom.parent", {{"C", "tip.C"}}, kReport);
}

/// The spacecraft as one body, tested in orbit.
FlexibleBody spacecraft() {
  Diagram part{"spacecraft"};
  auto hub = part.add("hub", kHub);
  mount(add_wing(part), hub.child("W"));
  return damping_of_assembly(part, "hub.parent", {{"tip", "tip.C"}}, kReport, RootBoundary::free);
}

/// The poles of the diagram, whose free body is `root`.
std::vector<Pole> show(const char* title, Diagram& d, const BodyHandle& root) {
  root.parent.force = -d.input("U", 6);
  d.output("accel", 6) = root.parent.accel;
  const std::vector<Pole> poles = compile(d).poles();
  std::printf("%s\n%s", title, to_string(poles).c_str());
  return poles;
}

}  // namespace

int main() {
  Diagram blocks{"blocks"}, bench{"bench"}, orbit{"orbit"};
  auto hub = blocks.add("hub", kHub), hub_of_bench = bench.add("hub", kHub);
  mount(add_wing(blocks), hub.child("W"));
  mount(bench.add("wing", wing()), hub_of_bench.child("W"));
  show("0.3 % of the boom's modes, clamped at its root", blocks, hub);
  show("the report, of the wing on a bench", bench, hub_of_bench);
  double off = 0;
  for (const Pole& p :
       show("the report, of the spacecraft in orbit", orbit, orbit.add("spacecraft", spacecraft())))
    off = std::max(off, std::abs(p.damping - kReport.at(p.omega)));
  return by_hand::agrees("damping of the report", off, 1e-10) ? 0 : 1;
}
