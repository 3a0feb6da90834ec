// A spring-mass is a block with two ports; which side of each port is the cause is free: the same
// block gives the paper's four causalities (eqs 3-6) and the free-free structure G(s).
#include <array>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

constexpr double m = 2, k = 50, m0 = 4;  // [kg], [N/m], [kg]

/// Two-port without the stretch reading: [xdd_C; f_P] from [f_C; xdd_P].
StateSpace two_port(const StateSpace& model) {
  StateSpace z = model;
  z.C = model.C.topRows(2).eval();
  z.D = model.D.topRows(2).eval();
  z.outputs.resize(2);
  return z;
}

/// The paper's Table of inverses, typed from it: A, B, C, D.
using Typed = std::array<Eigen::Matrix2d, 4>;

Eigen::Matrix2d rows(double a, double b, double c, double d) {
  return (Eigen::Matrix2d() << a, b, c, d).finished();
}

double difference(const StateSpace& z, const Typed& typed) {
  const std::array<Eigen::MatrixXd, 4> mine{z.A, z.B, z.C, z.D};
  double worst = 0;
  for (std::size_t i = 0; i < 4; ++i)
    worst = std::max(worst, (mine[i] - typed[i]).cwiseAbs().maxCoeff() /
                                std::max(typed[i].cwiseAbs().maxCoeff(), 1.0));
  return worst;
}

double difference(const StateSpace& a, const StateSpace& b) {
  return difference(a, Typed{b.A, b.B, b.C, b.D});
}

/// Free-free structure of eq. (6): forces u1 on the mass m and u2 on m0, their accelerations.
Diagram free_free() {
  Diagram d{"free-free"};
  auto u1 = d.input("u1");
  auto u2 = d.input("u2");
  auto z = d.add("z", SpringMass{.mass = m, .stiffness = k, .parent_mass = m0});
  z.child.force = u1;
  z.parent.force = -u2;  // imposing a force at P inverts that channel
  d.output("xdd_C") = z.child.accel;
  d.output("xdd_P") = z.parent.accel;
  return d;
}

}  // namespace

int main() {
  const SpringMass spec{.mass = m, .stiffness = k, .parent_mass = m0};
  const StateSpace Z = two_port(model_of(spec));
  const StateSpace Z_u = two_port(invert(spec, {"child"}));              // upper channel
  const StateSpace Z_l = two_port(invert(spec, {"parent"}));             // lower channel
  const StateSpace Z_inv = two_port(invert(spec, {"child", "parent"}));  // both
  std::printf("Z(m0 = %g, k = %g, m = %g)\n%s\n", m0, k, m, to_string(Z).c_str());
  std::printf("inverted at its parent: forces in, accelerations out\n%s\n", to_string(Z_l).c_str());

  const double wf2 = k * (m0 + m) / (m0 * m);
  const Typed typed_Z{rows(0, 1, -k / m, 0), rows(0, 0, 1 / m, -1), rows(-k / m, 0, k, 0),
                      rows(1 / m, 0, 0, -m0)};
  const Typed typed_inv{rows(0, 1, -k / m0, 0), rows(0, 0, 1, 1 / m0), rows(k, 0, k / m0, 0),
                        rows(m, 0, 0, -1 / m0)};
  const Typed typed_u{rows(0, 1, 0, 0), rows(0, 0, 1, -1), rows(k, 0, k, 0), rows(m, 0, 0, -m0)};
  const Typed typed_l{rows(0, 1, -wf2, 0), rows(0, 0, 1 / m, 1 / m0), rows(-k / m, 0, k / m0, 0),
                      rows(1 / m, 0, 0, -1 / m0)};
  bool ok = by_hand::agrees("Z is eq. (5)", difference(Z, typed_Z), 1e-14);
  ok &= by_hand::agrees("Z^-1 is the paper's", difference(Z_inv, typed_inv), 1e-14);
  ok &= by_hand::agrees("Z^-1u is the paper's", difference(Z_u, typed_u), 1e-14);
  ok &= by_hand::agrees("Z^-1l is the paper's", difference(Z_l, typed_l), 1e-14);

  const std::vector<std::pair<int, int>> upper{{0, 0}}, lower{{1, 1}}, both{{0, 0}, {1, 1}};
  ok &= by_hand::agrees(
      "[Z^-1l]^-1 = [Z^-1]^-1l = Z^-1u",
      std::max(difference(invert(Z_l, both), Z_u), difference(invert(Z_inv, lower), Z_u)), 1e-14);
  ok &= by_hand::agrees(
      "[Z^-1u]^-1 = [Z^-1]^-1u = Z^-1l",
      std::max(difference(invert(Z_u, both), Z_l), difference(invert(Z_inv, upper), Z_l)), 1e-14);
  // The same spring seen from its other end: J Z^-1(m0, k, m) J = Z(m, k, m0).
  const StateSpace turned =
      two_port(model_of(SpringMass{.mass = m0, .stiffness = k, .parent_mass = m}));
  const Eigen::Matrix2d J = rows(0, -1, 1, 0);
  std::vector<by_hand::MatrixXcd> left, right, poly, scene, hand;
  const System free = compile(free_free());
  for (const double w : {0.1, 1.0, 3.0, 10.0, 100.0}) {
    const by_hand::Complex s{0.1 * w, w}, s2 = s * s;
    left.push_back(J * Z_inv.transfer(s) * J);
    right.push_back(turned.transfer(s));
    by_hand::MatrixXcd G(2, 2);
    G << m0 * (s2 + k / m0), m * (k / m), m0 * (k / m0), m * (s2 + k / m);
    poly.push_back(G / (m * m0 * (s2 + wf2)));
    scene.push_back(free.transfer(s));
    const by_hand::Structure a{rows(m, 0, 0, m0), rows(0, 0, 0, 0), rows(k, -k, -k, k),
                               rows(1, 0, 0, 1), rows(1, 0, 0, 1)};
    hand.push_back(by_hand::accel_transfer(a, s));
  }
  ok &= by_hand::agrees("J Z^-1(m0, k, m) J = Z(m, k, m0)", by_hand::transfer_error(left, right),
                        1e-14);
  ok &= by_hand::agrees("G(s) of a scene with both forces given",
                        by_hand::transfer_error(scene, poly), 1e-14);
  ok &= by_hand::agrees("the same from M and K", by_hand::transfer_error(scene, hand), 1e-12);
  const auto poles = free.poles();
  ok &= by_hand::agrees("its pole is omega_f",
                        by_hand::pole_error(by_hand::moving(poles), {{0, std::sqrt(wf2)}}), 1e-14);
  std::printf("order %d, poles:\n%s", free.state_space().order(), to_string(poles).c_str());
  return ok && free.state_space().order() == 2 ? 0 : 1;
}
