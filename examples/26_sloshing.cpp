// Liquid in a tank under constant thrust, in two equivalent models: a mass on springs across the
// thrust axis, and a pendulum. The thrust accelerates all by g, which is no state of a linear
// model: its effect is the stiffness m g / l of the springs, or m g l of the pendulum. Along the
// axis the liquid moves with the tank: `slosh` puts its mass there by a force of -m times the
// acceleration. Both against M, D, K by hand.
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

const Vector3d hub_inertia{400, 420, 300}, liquid_at{0.1, 0, -0.4};  // centre of the liquid at rest
constexpr double hub_mass = 500, m = 60, g = 0.05, l = 0.3;          // [kg], [m/s^2], [m]
constexpr double k = m * g / l, xi = 0.005;                          // [N/m]
const double c = 2 * xi * std::sqrt(k * m);                          // [N s/m]

/// A pendulum that hangs from `site`, a length l ahead of the liquid.
void pendulum(Diagram& d, const DualPort<6>& site) {
  auto bob = d.add("bob", RigidBody{.mass = m, .inertia = Matrix3d::Zero(), .PA = {0, 0, -l}});
  auto pivot = joint(d, "pivot", bob, site, {}, {about({1, 0, 0}, "x"), about({0, 1, 0}, "y")});
  for (const char* axis : {"x", "y"})
    pivot.axis(axis).force =
        k * l * l * pivot.axis(axis).position + c * l * l * pivot.axis(axis).rate;
}

enum class Model { springs, pendulum };

Diagram satellite(Model model) {
  Diagram d{"satellite"};
  auto U = d.input("U", 6);
  auto hub = d.add("hub", RigidBody{.mass = hub_mass,
                                    .inertia = hub_inertia.asDiagonal(),
                                    .children = {{"liquid", liquid_at},
                                                 {"pivot", liquid_at + Vector3d(0, 0, l)}}});
  hub.parent.force = -U;
  if (model == Model::springs)
    slosh(d, "liquid", hub.child("liquid"), {.mass = m, .stiffness = k, .damping = c});
  else
    pendulum(d, hub.child("pivot"));
  d.output("accel", 6) = hub.parent.accel;
  return d;
}

/// Coordinates: hub 0 to 5, liquid against the tank along x and y 6 and 7.
by_hand::Structure satellite_by_hand() {
  by_hand::Structure a = by_hand::empty(8, 6, 6);
  a.M.topLeftCorner(3, 3).diagonal().setConstant(hub_mass);
  a.M.block(3, 3, 3, 3) = hub_inertia.asDiagonal();
  by_hand::MatrixXd liquid = by_hand::MatrixXd::Zero(3, 8);
  liquid.leftCols(6) = by_hand::tau(-liquid_at).topRows(3);
  liquid(0, 6) = liquid(1, 7) = 1;
  a.M += m * liquid.transpose() * liquid;
  a.K.diagonal().tail(2).setConstant(k);
  a.D.diagonal().tail(2).setConstant(c);
  a.B.topRows(6).setIdentity();
  a.C.leftCols(6).setIdentity();
  return a;
}

double error_by_hand(const System& system) {
  std::vector<by_hand::MatrixXcd> ours, right;
  for (const by_hand::Complex s : by_hand::ray(0.01, 100, 12)) {
    ours.push_back(system.transfer(s));
    right.push_back(by_hand::accel_transfer(satellite_by_hand(), s));
  }
  return by_hand::transfer_error(ours, right);
}

}  // namespace

int main() {
  std::printf("liquid in a tank at rest: %.4f rad/s\n", std::sqrt(g / l));
  bool ok = true;
  for (const auto& [name, model] :
       {std::pair("springs", Model::springs), {"pendulum", Model::pendulum}}) {
    const System system = compile(satellite(model));
    std::printf("%s: order %d, with the free satellite", name, system.state_space().order());
    for (const Pole& p : system.poles()) std::printf(" %.4f", p.omega);
    std::printf(" rad/s\n");
    ok = by_hand::agrees(name, error_by_hand(system), 1e-9) && ok;
  }
  return ok ? 0 : 1;
}
