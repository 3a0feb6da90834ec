// Liquid in a tank under constant thrust, in two equivalent models: a mass on springs across the
// thrust axis, and a pendulum. The thrust accelerates all by g, which is no state of a linear
// model: its effect is the stiffness m g / l of the springs, or m g l of the pendulum. Along the
// axis the liquid moves with the tank: `slosh` puts its mass there by a force of -m times the
// acceleration. Both against M, D, K by hand.
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/sloshing.hpp"

using namespace titop;
using namespace scenes::sloshing;

namespace {

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
       {std::pair("springs", Liquid::springs), {"pendulum", Liquid::pendulum}}) {
    const System system = compile(satellite(model));
    std::printf("%s: order %d, with the free satellite", name, system.state_space().order());
    for (const Pole& p : system.poles()) std::printf(" %.4f", p.omega);
    std::printf(" rad/s\n");
    ok = by_hand::agrees(name, error_by_hand(system), 1e-9) && ok;
  }
  return ok ? 0 : 1;
}
