// Blocks joined by equations: each line of the paper's Table 1 is one line here. Without inputs the
// scene still has its modes (Fig. 1); with an actuator, the model of x_3 has the ten states that
// the transfer needs, and eight if two masses have the same motion (Figs. 7, 8): decided without
// rounding, since all data are integers. The full certificate checks the model.
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

struct Numbers {
  std::array<double, 5> m, k;  // [kg], [N/m]
};
constexpr Numbers plain{{5, 4, 3, 2, 1}, {500, 300, 450, 260, 170}};
constexpr Numbers twins{{5, 4, 3, 2, 1}, {500, 300, 450, 260, 130}};  // k4/m4 = k5/m5

enum class With { nothing, actuator };

Diagram five_masses(const Numbers& n, With with) {
  Diagram d{"five masses"};
  auto z1 = d.add("z1", SpringMass{.mass = n.m[0], .stiffness = n.k[0]});
  auto z2 = d.add("z2", SpringMass{.mass = n.m[1], .stiffness = n.k[1]});
  auto z3 = d.add("z3", SpringMass{.mass = n.m[2], .stiffness = n.k[2]});
  auto z4 = d.add("z4", SpringMass{.mass = n.m[3], .stiffness = n.k[3]});
  auto z5 = d.add("z5", SpringMass{.mass = n.m[4], .stiffness = n.k[4]});

  z1.parent.accel = 0;  // the wall
  z2.parent.accel = z1.child.accel;
  z3.parent.accel = z1.child.accel;
  z4.parent.accel = z2.child.accel;
  z5.parent.accel = z2.child.accel;
  z1.child.force += z2.parent.force + z3.parent.force;
  z2.child.force += z4.parent.force + z5.parent.force;
  if (with == With::nothing) return d;

  auto u = d.input("u");  // an actuator between masses 1 and 2 [N]
  z1.child.force += -u;
  z2.child.force += u;
  d.output("x1") = z1.position;  // [m]
  d.output("x2") = z2.position;
  d.output("x3") = z1.stretch + z3.stretch;  // the same as z3.position
  d.output("x4") = z4.position;
  d.output("x5") = z5.position;
  d.output("xdd3") = z3.child.accel;  // [m/s^2]
  return d;
}

Diagram only_x3(const Numbers& n) {
  Diagram d{"x3 alone"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = n.m[0], .stiffness = n.k[0]});
  auto z2 = d.add("z2", SpringMass{.mass = n.m[1], .stiffness = n.k[1]});
  auto z3 = d.add("z3", SpringMass{.mass = n.m[2], .stiffness = n.k[2]});
  auto z4 = d.add("z4", SpringMass{.mass = n.m[3], .stiffness = n.k[3]});
  auto z5 = d.add("z5", SpringMass{.mass = n.m[4], .stiffness = n.k[4]});
  ground(z1);
  mount(z2, z1.child);  // the two equations of a joint in one word
  mount(z3, z1.child);
  mount(z4, z2.child);
  mount(z5, z2.child);
  z1.child.force += -u;
  z2.child.force += u;
  d.output("x3") = z3.position;
  return d;
}

/// Five masses in their absolute positions.
by_hand::Structure by_hand_five(const Numbers& n) {
  constexpr std::array<int, 5> hangs_on{-1, 0, 0, 1, 1};
  by_hand::Structure a = by_hand::empty(5, 1, 5);
  for (int i = 0; i < 5; ++i) {
    const double k = n.k[static_cast<std::size_t>(i)];
    const int p = hangs_on[static_cast<std::size_t>(i)];
    a.M(i, i) = n.m[static_cast<std::size_t>(i)];
    a.K(i, i) += k;
    if (p < 0) continue;
    a.K(p, p) += k;
    a.K(i, p) -= k;
    a.K(p, i) -= k;
  }
  a.B << -1, 1, 0, 0, 0;
  a.C.setIdentity();
  return a;
}

}  // namespace

int main() {
  const by_hand::Structure a = by_hand_five(plain), b = by_hand_five(twins);

  const System fig1 = compile(five_masses(plain, With::nothing));
  std::printf("Fig. 1, no inputs: order %d\n%s", fig1.state_space().order(),
              to_string(fig1.poles()).c_str());
  bool ok =
      by_hand::agrees("poles against M and K",
                      by_hand::pole_error(by_hand::moving(fig1.poles()), by_hand::poles(a)), 1e-13);

  const System fig8 = compile(five_masses(plain, With::actuator));
  std::vector<by_hand::MatrixXcd> scene, hand, dense;
  for (const double w : {0.5, 3.0, 7.0, 11.0, 15.0, 18.0, 40.0}) {
    const by_hand::Complex s{0, w};
    scene.push_back(fig8.transfer(s));
    dense.push_back(fig8.state_space().transfer(s));
    by_hand::MatrixXcd x = by_hand::position_transfer(a, s);
    x.conservativeResize(6, 1);
    x(5) = s * s * x(2);
    hand.push_back(x);
  }
  std::printf("\nFig. 8: order %d\n", fig8.state_space().order());
  ok &= by_hand::agrees("transfer against M and K", by_hand::transfer_error(scene, hand), 1e-13);
  ok &= by_hand::agrees("dense model against M and K", by_hand::transfer_error(dense, hand), 1e-12);
  ok &= fig8.state_space().order() == 10;
  std::printf("xdd_3 / u at 3 rad/s: %.12f\n",
              fig8.transfer({0, 3})(fig8.output("xdd3"), fig8.input("u")).real());
  const Eigen::MatrixXd rest = fig8.static_gain();
  std::printf("x at rest under 1 N:");
  for (int i = 0; i < 5; ++i)  // two of them are 0 up to rounding, of either sign
    std::printf(" %.7f", std::round(rest(i, 0) * 1e7) / 1e7 + 0.0);
  std::printf(" m\n");

  std::printf("\nu to x_3 alone\n");
  for (const auto& [name, numbers, matrices] :
       {std::tuple{"general", &plain, &a}, std::tuple{"k4/m4 = k5/m5", &twins, &b}}) {
    const System x3 = compile(only_x3(*numbers), {.exact_up_to = 10});
    by_hand::Structure c = *matrices;
    c.C = matrices->C.row(2);
    const int least = by_hand::least_order(c);
    std::printf("  %-14s order %d, from M and K %d\n", name, x3.state_space().order(), least);
    std::printf("  %-14s %s\n", "", to_string(exact_order(only_x3(*numbers).graph())).c_str());
    ok &= x3.state_space().order() == least && x3.order_verdict().decided();
  }

  const FullCertificate full = certify(fig8);
  std::printf("\nFig. 8 certified in full: %d of %d poles measured, order %s, %s\n",
              full.poles.measured, full.poles.count, full.order.decided() ? "decided" : "undecided",
              full.holds() ? "no fault found" : full.faults.front().c_str());
  ok &= full.holds() && full.order.decided();
  return ok ? 0 : 1;
}
