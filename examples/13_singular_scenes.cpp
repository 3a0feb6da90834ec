// Points without mass: springs in series through a ring, a force on the ring. Outputs that need no
// derivative of an input have a model of minimal order; the others are refused with an error that
// names them. Then a plate whose motion is prescribed at two points, and a rod without mass between
// ball joints, free to turn about its own axis.
#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

constexpr double k1 = 30, k2 = 50, k3 = 20, m2 = 2, m3 = 1.5;  // [N/m], [kg]
constexpr double m_ship = 900, m_load = 300;                   // [kg]

/// Three springs meet in a ring without mass: one from the wall, one to each of two masses. The
/// wall fixes the free end of the first (its own mass does not count there).
Diagram ring(bool ask_its_acceleration) {
  Diagram d{"ring"};
  auto u = d.input("u");  // on the ring [N]
  auto z1 = d.add("z1", SpringMass{.mass = 1, .stiffness = k1});
  auto z2 = d.add("z2", SpringMass{.mass = m2, .stiffness = k2});
  auto z3 = d.add("z3", SpringMass{.mass = m3, .stiffness = k3});

  z1.child.accel = 0;  // the wall
  z2.parent.accel = z1.parent.accel;
  z3.parent.accel = z1.parent.accel;
  z1.parent.force = -z2.parent.force - z3.parent.force - u;  // nothing has mass there
  d.output("x_2") = z2.stretch - z1.stretch;                 // [m]
  d.output("x_ring") = -1.0 * z1.stretch;
  if (ask_its_acceleration) d.output("xdd_ring") = z1.parent.accel;
  return d;
}

/// A plate on a shaker that moves it at two points; a spring-mass is mounted on it.
Diagram shaker(bool one_command) {
  Diagram d{"shaker"};
  auto u = d.input("u", 6), v = d.input("v", 6);
  auto plate = d.add("plate", RigidBody{.mass = 4, .children = {{"far", {1, 0, 0}}}});
  auto z = d.add("z", SpringMass{.mass = m2, .stiffness = k2});
  plate.parent.accel = u;
  if (one_command)
    plate.child.accel = tau({-1, 0, 0}) * u;  // motion of the far point due to u: given twice
  else
    plate.child.accel = v;
  mount(z, plate.child.along({0, 1, 0}));
  d.output("xdd") = z.child.accel;
  d.output("unused", 6) = v;
  return d;
}

/// A ship tows a load by a rod without mass, a ball joint at both ends.
Diagram tow(bool ask_how_the_rod_turns) {
  Diagram d{"tow"};
  auto U = d.input("U", 6);  // on the ship [N, N m]
  auto ship = d.add("ship", RigidBody{.mass = m_ship, .children = {{"stern", {-2, 0, 0.5}}}});
  auto rod =
      d.add("rod",
            RigidBody{.mass = 0, .inertia = Matrix3d::Zero(), .children = {{"end", {-1.5, 0, 0}}}});
  auto load = d.add("load", RigidBody{.mass = m_load, .PA = {-0.4, 0.1, 0}});
  ship.parent.force = -U;
  joint(d, "hook", rod, ship.child, {}, ball());
  joint(d, "eye", load, rod.child, {}, ball());
  d.output("xdd", 6) = load.parent.accel;
  if (ask_how_the_rod_turns) d.output("turn", 6) = rod.child.accel;
  return d;
}

/// The same by hand: one constraint, the rod keeps its length, and one unknown, the force in it.
by_hand::MatrixXd towed() {
  by_hand::MatrixXd M = by_hand::MatrixXd::Zero(12, 12), J(1, 12);
  const by_hand::Matrix6 at_A = by_hand::tau({0.4, -0.1, 0});
  by_hand::Matrix6 ship = by_hand::Matrix6::Identity(), load = ship;
  ship.diagonal().head<3>().setConstant(m_ship), load.diagonal().head<3>().setConstant(m_load);
  M.topLeftCorner(6, 6) = ship;
  M.bottomRightCorner(6, 6) = at_A.transpose() * load * at_A;
  J << by_hand::tau({2, 0, -0.5}).row(0), -by_hand::Matrix6::Identity().row(0);
  const by_hand::MatrixXd by_force = M.inverse().leftCols(6), by_rod = M.inverse() * J.transpose();
  return (by_force - by_rod * (J * by_rod).inverse() * (J * by_force)).bottomRows(6);
}

void print_refusal(const Diagram& d) {
  try {
    compile(d);
  } catch (const Error& error) {
    std::printf("%s\n", error.what());
  }
}

}  // namespace

int main() {
  const System system = compile(ring(false));
  std::printf("%s", system.log().c_str());

  // By hand: the ring's row of M is 0.
  by_hand::Structure a = by_hand::empty(3, 1, 2);
  a.M.diagonal() << 0, m2, m3;
  a.K << k1 + k2 + k3, -k2, -k3, -k2, k2, 0, -k3, 0, k3;
  a.B << 1, 0, 0;
  a.C << 0, 1, 0, 1, 0, 0;
  std::vector<by_hand::MatrixXcd> scene, dense, hand;
  for (const double w : {0.5, 1.0, 3.0, 9.0, 30.0}) {
    const by_hand::Complex s{0.1 * w, w};
    scene.push_back(system.transfer(s));
    dense.push_back(system.state_space().transfer(s));
    hand.push_back(by_hand::position_transfer(a, s));
  }
  std::printf("order %d, poles:\n%s", system.state_space().order(),
              to_string(system.poles()).c_str());
  bool ok =
      by_hand::agrees("transfer against M and K", by_hand::transfer_error(scene, hand), 1e-13);
  ok &= by_hand::agrees("dense model against M and K", by_hand::transfer_error(dense, hand), 1e-12);

  std::printf("\nthe ring's acceleration:\n");
  print_refusal(ring(true));

  const System shaken = compile(shaker(true));
  std::printf("\none command at two points: order %d\n", shaken.order());
  const by_hand::Complex s{0.3, 2.2}, follows = k2 / (m2 * s * s + k2);
  by_hand::MatrixXcd exact = by_hand::MatrixXcd::Zero(1, 12);
  exact(1) = exact(5) = follows;
  ok &= by_hand::agrees("transfer against one equation",
                        (shaken.transfer(s).topRows(1) - exact).cwiseAbs().maxCoeff(), 1e-14);
  std::printf("\ntwo commands at two points of a rigid plate:\n");
  print_refusal(shaker(false));

  const System towing = compile(tow(false));
  std::printf("\na rod without mass between ball joints:\n");
  for (const Note& note : towing.notes())
    if (note.pass == "reduce") std::printf("%s\n", note.text.c_str());
  ok &= by_hand::agrees(
      "transfer against one constraint",
      by_hand::transfer_error({towing.transfer(s)}, {by_hand::MatrixXcd(towed())}, 3, 3), 1e-13);
  std::printf("\nhow it turns:\n");
  print_refusal(tow(true));
  return ok && system.order() == 4 && shaken.order() == 2 ? 0 : 1;
}
