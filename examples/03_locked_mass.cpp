// Forces and motions may be imposed at either end of a chain: mass 0 is free under a force, mass 2
// is locked, and the blocks invert the two channels by themselves (Figs. 12, 13, Table 2).
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

constexpr double m0 = 2, k1 = 50, m1 = 3, k2 = 80, m2 = 1.5;  // [kg], [N/m]

Diagram locked_mass() {
  Diagram d{"locked mass"};
  auto u = d.input("u");  // [N]
  auto z1 = d.add("z1", SpringMass{.mass = m1, .stiffness = k1, .parent_mass = m0});
  auto z2 = d.add("z2", SpringMass{.mass = m2, .stiffness = k2});

  z1.parent.force = -u;  // m0 is free: its acceleration is an output
  mount(z2, z1.child);
  z2.child.accel = 0;  // m2 is locked: the force that holds it is an output
  d.output("xdd_0") = z1.parent.accel;
  d.output("xdd_1") = z1.child.accel;
  d.output("f_lock") = z2.child.force;  // f_{3/2}, by the lock on m2
  return d;
}

}  // namespace

int main() {
  const System system = compile(locked_mass());
  std::printf("%s", system.log().c_str());

  // By hand: x0 and x1 are free, x2 = 0; the lock bears the force of spring 2: f = -k2 x1.
  by_hand::Structure a = by_hand::empty(2, 1, 2);
  a.M.diagonal() << m0, m1;
  a.K << k1, -k1, -k1, k1 + k2;
  a.B << 1, 0;
  a.C.setIdentity();
  std::vector<by_hand::MatrixXcd> scene, dense, hand;
  for (const double w : {0.5, 1.0, 3.0, 5.0, 9.0, 30.0}) {
    const by_hand::Complex s{0, w};
    scene.push_back(system.transfer(s));
    dense.push_back(system.state_space().transfer(s));
    const by_hand::MatrixXcd x = by_hand::position_transfer(a, s);
    by_hand::MatrixXcd y(3, 1);
    y << s * s * x(0), s * s * x(1), -k2 * x(1);
    hand.push_back(y);
  }
  std::printf("\norder %d, poles:\n%s", system.state_space().order(),
              to_string(system.poles()).c_str());
  const by_hand::MatrixXcd at_3 = system.transfer({0, 3});
  std::printf("at 3 rad/s: xdd_0 %.12f, xdd_1 %.12f, f_lock %.12f\n", at_3(0).real(),
              at_3(1).real(), at_3(2).real());
  bool ok =
      by_hand::agrees("transfer against M and K", by_hand::transfer_error(scene, hand), 1e-13);
  ok &= by_hand::agrees("dense model against M and K", by_hand::transfer_error(dense, hand), 1e-12);
  ok &= by_hand::agrees("poles against M and K",
                        by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(a)),
                        1e-13);
  return ok && system.state_space().order() == 4 ? 0 : 1;
}
