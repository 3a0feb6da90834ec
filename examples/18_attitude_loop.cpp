// No more states than the scene needs, with a controller in the loop: the satellite of
// scenes/satellite.cpp whose hub is controlled by a law with an actuator and a delay. With the
// controller it is no passive structure and has no M, D, K form, so its states are balanced
// instead: states on the imaginary axis (here the hub's free translation, if an output needs it)
// are kept, the rest balanced and reduced to those that a disturbance and a command need for the
// attitude, the law's torque and one tip, up to 20 Hz. With a bound on the error, and compared with
// the loop closed by hand.
#include <Eigen/LU>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/satellite.hpp"
#include "scenes/satellite_by_hand.hpp"

using namespace titop;
using Eigen::MatrixXd;

namespace {

/// Torque = (kp + kd s) / (s / actuator + 1) (1 - s delay / 2) / (1 + s delay / 2) times the
/// attitude error, for each axis.
constexpr double kp = 30, kd = 45, actuator = 40, delay = 0.02;

FlexibleBody boom() {
  return Beam{.length = 2,
              .section = rectangle(0.06, 0.04),
              .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
              .elements = 10,
              .modes = {.xi = {0.005}}};
}

/// gain + pole / (s + corner) for each of three signals.
Lti first_order(double gain, double pole, double corner) {
  const MatrixXd I = MatrixXd::Identity(3, 3);
  return {.A = -corner * I, .B = I, .C = pole * I, .D = gain * I};
}

Diagram controlled(const FlexibleBody& beam) {
  Diagram d{"controlled"};
  auto T = d.input("T", 3);            // disturbance on the hub [N m]
  auto wanted = d.input("wanted", 3);  // attitude [rad]
  auto hub = d.add("hub", scenes::hub_spec);
  auto boom1 = d.add("boom1", beam), boom2 = d.add("boom2", beam);
  auto law = d.add("law", first_order(kd * actuator, (kp - kd * actuator) * actuator, actuator));
  auto late = d.add("late", first_order(-1, 4 / delay, 2 / delay));
  mount(boom1, hub.child("C1"), Rotation::about(scenes::turn1, scenes::angle1));
  auto drive = hinge(d, "drive", boom2, hub.child("C2"),
                     Rotation::about(scenes::turn2, scenes::angle2), scenes::hinge_axis);
  drive.torque = scenes::kappa * drive.angle + scenes::c * drive.rate;
  law.in = wanted - hub.parent.position.angular();
  late.in = law.out;
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -T - late.out;
  d.output("attitude", 3) = hub.parent.position.angular();
  d.output("torque", 3) = late.out;
  d.output("tip2", 3) = boom2.child("C").accel.linear;
  return d;
}

/// [attitude; torque; tip2] from [T; wanted]: M, D and K by hand, and the loop closed on paper.
by_hand::MatrixXcd closed_by_hand(const by_hand::Structure& a, by_hand::Complex s) {
  using by_hand::Complex;
  using by_hand::MatrixXcd;
  const MatrixXcd G = by_hand::position_transfer(a, s), I = MatrixXcd::Identity(3, 3);
  const MatrixXcd turn = G.block(3, 3, 3, 3), tip = s * s * G.block(12, 3, 3, 3);
  const Complex C =
      (kp + kd * s) / (s / actuator + 1.0) * (1.0 - s * delay / 2.0) / (1.0 + s * delay / 2.0);
  const MatrixXcd S = (I + C * turn).inverse();  // sensitivity: torque per disturbing torque
  MatrixXcd H(9, 6);
  H << turn * S, C * turn * S, -C * turn * S, C * S, tip * S, C * tip * S;
  return H;
}

/// Largest error of any pair, each over its own peak; the lowest frequencies, where the law works,
/// once more in fine steps.
double error_by_hand(const ReducedSystem& r, const by_hand::Structure& a, const Scene& scene) {
  std::vector<by_hand::MatrixXcd> small, exact;
  for (const double hertz : {scene.band_hz[1], scene.band_hz[1] / 400})
    for (const by_hand::Complex s : by_hand::ray(scene.damping_floor, hertz, 400))
      small.push_back(r.transfer(s)), exact.push_back(closed_by_hand(a, s));
  return by_hand::transfer_error(small, exact);
}

}  // namespace

int main() {
  const FlexibleBody beam = boom();
  const Diagram d = controlled(beam);
  const Scene scene{.band_hz = {0, 20}, .accuracy = 1e-3};
  const ReducedSystem r = compile(d, scene);
  std::printf("%s: %d states instead of %d\n", d.name().c_str(), r.order(), r.full().order());
  for (const ReductionStep& s : r.steps())
    std::printf("  %s: %d -> %d\n    %s\n", s.name.c_str(), s.before, s.after, s.text.c_str());
  bool ok = r.bound().worst <= scene.accuracy;
  std::printf("bound below 1e-3: %s\n", ok ? "yes" : "NO");
  ok &= by_hand::agrees("against M, D, K and the loop by hand",
                        error_by_hand(r, scenes::satellite_by_hand(beam.data()), scene), 1.01e-3);

  const StateSpace m = r.state_space();
  bool stable = true;
  for (const Pole& p : poles(m)) stable &= p.s.real() < 0;
  std::printf("stable as the loop is: %s\n", stable ? "yes" : "NO");
  ok &= stable && r.inputs() == r.full().inputs() && r.outputs() == r.full().outputs();

  std::printf("\naccuracy  states\n");
  const std::vector<double> accuracies{1e-1, 1e-2, 1e-3, 1e-4};
  for (const WhatIf& w : what_if(d, scene, accuracies))
    std::printf("%8.0e  %6d\n", w.accuracy, w.order);

  try {
    r.second_order();
    ok = false;
  } catch (const Error& error) {
    std::printf("\n%s\n", error.what());
  }
  return ok ? 0 : 1;
}
