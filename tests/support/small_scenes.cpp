#include "support/small_scenes.hpp"

#include "support/five_masses.hpp"

namespace titop_test {
namespace {

using namespace titop;

const Rotation kTurn = Rotation::about({1, 2, 3}, 0.7);

SpringMass spring(double mass, double stiffness, double parent_mass = 0) {
  return {.mass = mass, .stiffness = stiffness, .damping = 0.2, .parent_mass = parent_mass};
}

RigidBody brick(double mass) {
  return {.mass = mass,
          .inertia = Vector3d(1, 2, 2.5).asDiagonal(),
          .PA = {0.3, -0.2, 0.1},
          .children = {{"C1", {1, 0, 0.5}}, {"C2", {-1, 0.4, 0}}}};
}

FlexibleBody wing() {
  ModalData d;
  d.omega = Eigen::Vector2d(3, 8);
  d.xi = Eigen::Vector2d(0.01, 0.02);
  d.L_P = Eigen::MatrixXd::Zero(2, 6);
  d.L_P << 0.1, 1.2, 0.3, -0.2, 0.5, 0.9, 0.7, -0.4, 0.6, 0.3, -0.8, 0.1;
  d.D_P = rigid_mass(9, Vector3d(4, 5, 6).asDiagonal(), {-0.5, 0, 0.1});
  Eigen::MatrixXd Phi(6, 2);
  Phi << 0.1, 0.2, 0.5, -0.3, 0.2, 0.4, 0.1, 0, -0.2, 0.3, 0.4, 0.1;
  d.children.push_back({"F", {2, 0, 0.3}, Phi});
  return d;
}

Diagram fig_12() {
  Diagram d{"locked and released"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 3, .stiffness = 50, .parent_mass = 2});
  auto z2 = d.add("z2", spring(1.5, 80));
  z1.parent.force = -u;
  mount(z2, z1.child);
  z2.child.accel = 0;
  d.output("a0") = z1.parent.accel;
  d.output("lock") = z2.child.force;
  return d;
}

Diagram loose_parts() {
  Diagram d{"loose parts"};
  auto u = d.input("u"), unused = d.input("unused");
  auto z1 = d.add("z1", spring(1, 2)), z2 = d.add("z2", spring(2, 3));
  ground(z1);
  mount(z2, z1.child);
  z2.child.force = u;
  auto undriven = d.add("undriven", spring(1, 5)), unseen = d.add("unseen", spring(1, 6));
  auto deaf = d.add("deaf", Integrator{});    // sees the scene, is unobservable
  auto still = d.add("still", Integrator{});  // is unreachable, but acts on the scene
  ground(undriven), ground(unseen);
  unseen.child.force = u;
  deaf.in = z1.stretch;
  still.in = undriven.stretch;
  z1.child.force += still.out;
  auto island = d.add("island", Integrator{});  // is coupled to nothing
  island.in = -1 * island.out;
  d.output("x") = z2.position;
  d.output("dead") = undriven.stretch;
  d.output("through", 2) =
      Eigen::MatrixXd{{1, 0, 2}, {0, 3, 0}} * Eigen::MatrixXd{{1}, {2}, {3}} * (unused + 2 * u);
  return d;
}

Diagram controllers() {
  Diagram d{"controllers"};
  auto u = d.input("u");
  auto k = d.param("k", 3.5);
  auto z1 = d.add("z1", spring(2, 9)), z2 = d.add("z2", spring(1, 4));
  auto K = d.add("K", Lti{.A = Eigen::MatrixXd{{-2, 1}, {0, -5}},
                          .B = Eigen::MatrixXd{{0}, {1}},
                          .C = Eigen::MatrixXd{{1, 0.5}},
                          .D = Eigen::MatrixXd{{0.3}}});
  auto rate = d.add("rate", Integrator{}), place = d.add("place", Integrator{});
  auto sum = d.add("sum", Sum{.signs = "+--"});
  auto gain = d.add("gain", Gain{.gain = k});
  auto mix = d.add("mix", MatrixGain{.matrix = Eigen::MatrixXd{{0.2}, {-0.7}}});
  ground(z1);
  mount(z2, z1.child);
  rate.in = z2.child.accel;
  place.in = rate.out;
  K.in = z2.child.accel;  // feeds through, back to the acceleration: an algebraic loop
  gain.in = place.out;
  mix.in = rate.out;
  sum.in(1) = u;
  sum.in(2) = K.out;
  sum.in(3) = gain.out + Eigen::MatrixXd{{1, 2}} * mix.out;
  z2.child.force = sum.out;
  d.output("x") = z2.position;
  d.output("mix", 2) = mix.out;
  d.output("support") = z1.parent.reaction - k * z1.stretch;
  return d;
}

Diagram pins() {
  Diagram d{"pins and sliders"};
  auto U = d.input("U", 6);
  auto t = d.input("t", 3);
  auto f = d.input("f");
  auto hub = d.add("hub", brick(20)), link = d.add("link", brick(5)), end = d.add("end", brick(2));
  auto panel = d.add("panel", wing());
  hub.parent.accel.linear = 0;  // a pin
  hub.parent.force.angular = -t;
  const Rotation T_hub_link = kTurn.named("hub", "link");  // a ball joint
  link.parent.accel.linear = T_hub_link.inverse() * hub.child("C1").accel.linear;
  release(link);
  hub.child("C1").force.linear += T_hub_link * link.parent.force.linear;
  mount(panel, hub.child("C2"), kTurn);
  panel.child("F").force = U;
  const Rotation to_end = Rotation{}.named("end", "link");  // a slider along (3, 4, 0)
  const auto rail = link.child("C1");
  end.parent.accel.angular = to_end * rail.accel.angular;
  for (const Vector3d& r : {Vector3d(-4, 3, 0), Vector3d(0, 0, 1)})
    end.parent.accel.along(r) = to_end * rail.accel.along(r);
  end.parent.force.along({3, 4, 0}) = -f;
  rail.force += to_end.inverse() * end.parent.force;
  d.output("panel", 6) = panel.child("F").accel;
  d.output("pin", 6) = hub.parent.force;
  d.output("link", 3) = link.parent.accel.angular;
  d.output("end", 6) = end.parent.accel;
  return d;
}

Diagram hinges() {
  Diagram d{"hinges"};
  auto U = d.input("U", 6);
  auto motor = d.input("motor"), sweep = d.input("sweep");
  auto hub = d.add(
      "hub", RigidBody{.mass = 50,
                       .inertia = Vector3d(20, 30, 40).asDiagonal(),
                       .children = {{"C1", {1, 0, 0}}, {"C2", {0, 1, 0}}, {"C3", {0, 0, 1}}}});
  auto arm1 = d.add("arm1", wing());
  auto arm2 = d.add("arm2", brick(3)), arm3 = d.add("arm3", brick(4));
  hub.parent.force = -U;
  auto h1 = hinge(d, "h1", arm1, hub.child("C1"), kTurn, {0, 3, 4});
  auto h2 = hinge(d, "h2", arm2, hub.child("C2"), {}, {1, 0, 0});
  auto h3 = hinge(d, "h3", arm3, hub.child("C3"), kTurn.inverse(), {0, 1, 0});
  h1.torque = 30 * h1.angle + 2 * h1.rate - motor;
  h2.accel = 0;
  h3.accel = sweep;
  d.output("tip", 6) = arm1.child("F").accel;
  d.output("angles", 2) =
      Eigen::MatrixXd{{1}, {0}} * h1.angle + Eigen::MatrixXd{{0}, {1}} * h3.angle;
  d.output("lock") = h2.torque;
  d.output("hub", 6) = hub.parent.accel;
  return d;
}

Diagram held() {
  Diagram d{"held"};
  auto u = d.input("u"), w = d.input("w");
  auto z1 = d.add("z1", spring(2, 9, 1)), z2 = d.add("z2", spring(1, 4));
  release(z1);
  z1.child.accel = w;
  mount(z2, z1.child);
  z1.child.force += 3 * u;
  z2.child.force = u;
  d.output("total") = z1.child.force;
  d.output("support") = z1.child.reaction;
  d.output("a") = z1.parent.accel;
  return d;
}

}  // namespace

const std::vector<NamedScene>& scenes() {
  static const std::vector<NamedScene> all{
      {"five masses", [] { return five_masses_scene(kMasses, kStiffnesses); }, 10, {}},
      {"locked and released", fig_12, 4, {"z1.parent", "z2.child"}},
      {"loose parts", loose_parts, 4, {}},
      {"controllers", controllers, 6, {}},
      {"pins and sliders", pins, 4, {"end.parent", "hub.parent", "link.parent"}},
      {"hinges", hinges, 8, {"h1", "hub.parent"}},
      {"held", held, 4, {"z1.child", "z1.parent"}}};
  return all;
}

}  // namespace titop_test
