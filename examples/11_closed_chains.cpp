// Closed chains: a four-bar mechanism of three flexible links on free pins, its crank turned by a
// motor through a shaft. The last joint closes the chain: coordinates that follow from the others
// are no states of the model, but can still be read by name. Then the same chain of rigid links
// on hinges with six-component ports, of whose six closing equations three are redundant.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

constexpr double kPi = std::numbers::pi, kShaft = 5e4;  // [N m/rad]

struct Links {
  FlexibleBody crank, coupler, rocker;
};

Rotation turn(double angle) { return Rotation::about({0, 0, 1}, angle); }

/// A parallelogram of sides `a` (crank and rocker, upright) and `b` (coupler, along x) [m].
Diagram four_bar(const Links& links, double b) {
  Diagram d{"four-bar"};
  auto motor = d.input("motor");  // turns the crank [N m]
  auto base = d.add("base", RigidBody{.mass = 1, .children = {{"J1"}, {"J2", {b, 0, 0}}}});
  auto crank = d.add("crank", links.crank), coupler = d.add("coupler", links.coupler),
       rocker = d.add("rocker", links.rocker);
  const Vector3d z{0, 0, 1};
  ground(base);
  auto shaft = hinge(d, "shaft", crank, base.child("J1"), turn(kPi / 2), z);
  hinge(d, "p2", coupler, crank.child, turn(-kPi / 2), z).torque = 0;
  hinge(d, "p3", rocker, base.child("J2"), turn(kPi / 2), z).torque = 0;
  auto p4 = d.add("p4", Hinge{z});
  mount(p4, rocker.child, turn(-kPi / 2));
  weld(coupler.child, p4.child);  // closes the chain
  p4.torque = 0;
  shaft.torque = kShaft * shaft.angle - motor;
  d.output("tip", 3) = coupler.child.position.linear();  // [m]
  d.output("speed") = shaft.rate;                        // [rad/s]
  return d;
}

Beam tube_beam(double length) {
  return {.length = length,
          .section = tube(0.04, 0.03),
          .material = {.E = 70e9, .nu = 0.25, .rho = 2700},
          .elements = 3};
}

RigidBody rod(double length, double mass) {
  const double I = mass * length * length / 12;
  return {.mass = mass,
          .inertia = Vector3d(0, I, I).asDiagonal(),
          .PA = {length / 2, 0, 0},
          .children = {{"C", {length, 0, 0}}}};
}

void print_chain(const System& system) {
  for (const Note& n : system.notes())
    if (n.pass == "chains" || n.pass == "close") std::printf("  %s\n", n.text.c_str());
}

}  // namespace

int main() {
  constexpr double a = 0.4, b = 0.9, m = 1.5, m_coupler = 2.5;
  const Links flexible{FlexibleBody{tube_beam(a)}, FlexibleBody{tube_beam(b)},
                       FlexibleBody{tube_beam(a)}};
  const System soft = compile(four_bar(flexible, b), {.minimize_up_to = 0});
  std::printf("flexible links: order %d\n", soft.order());
  print_chain(soft);

  const Links stiff{rod(a, m), rod(b, m_coupler), rod(a, m)};
  const System rigid = compile(four_bar(stiff, b));
  std::printf("rigid links: order %d\n", rigid.order());
  print_chain(rigid);
  std::printf("%s", to_string(rigid.poles()).c_str());

  // By hand: crank and rocker turn by phi, the coupler moves by a phi along x and does not turn.
  const double inertia = 2 * (m * a * a / 3) + m_coupler * a * a;
  const double omega = std::sqrt(kShaft / inertia);
  bool ok = by_hand::agrees("frequency against one equation",
                            std::abs(rigid.poles().at(0).omega / omega - 1), 1e-12);
  const by_hand::Complex s{1, 30};
  const by_hand::Complex phi = 1.0 / (inertia * s * s + kShaft);
  ok &= by_hand::agrees("tip against one equation",
                        std::abs(rigid.transfer(s)(0, 0) / (-a * phi) - 1.0), 1e-12);
  ok &= rigid.order() == 2;
  // 3 x 18 modes and the shaft's angle, less 6 closures, of which the 3 free pins take up 3.
  ok &= soft.order() == 2 * (3 * 18 + 1 - (6 - 3));
  return ok ? 0 : 1;
}
