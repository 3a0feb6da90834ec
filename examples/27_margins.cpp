// The margins of an attitude loop: the satellite of scenes/satellite.cpp, whose hub is turned by a
// PD law per axis with an actuator's lag and a delay. The loop is cut where the law's torque enters
// (d.loop_point), three axes at once. Each axis alone, all three together, and the same from M, D,
// K and the law on paper; then with twice the gain that the margin allows. At last the law as a
// digital controller runs it, with samples of the attitude 100 times a second.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/satellite.hpp"
#include "scenes/satellite_by_hand.hpp"

using namespace titop;
using Eigen::MatrixXd;

namespace {

constexpr double kp = 30, kd = 45, actuator = 40, delay = 0.02;

FlexibleBody boom() {
  return Beam{.length = 2,
              .section = rectangle(0.06, 0.04),
              .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
              .elements = 10,
              .modes = {.kept = 6, .xi = {0.005}}};
}

/// gain + pole / (s + corner) for each of three signals.
Lti first_order(double gain, double pole, double corner) {
  const MatrixXd I = MatrixXd::Identity(3, 3);
  return {.A = -corner * I, .B = I, .C = pole * I, .D = gain * I};
}

/// The law of all three axes.
Lti law_block() { return first_order(kd * actuator, (kp - kd * actuator) * actuator, actuator); }

/// The delay of all three torques, by its Pade approximation of one state.
Lti late_block() {
  const Lti one = pade(delay, 1);
  const MatrixXd I = MatrixXd::Identity(3, 3);
  return {.A = one.A(0, 0) * I, .B = one.B(0, 0) * I, .C = one.C(0, 0) * I, .D = one.D(0, 0) * I};
}

Diagram controlled(const FlexibleBody& beam) {
  Diagram d{"controlled"};
  auto T = d.input("T", 3);  // disturbance on the hub [N m]
  auto gain = d.param("gain", 1.0);
  auto hub = d.add("hub", scenes::hub_spec);
  auto boom1 = d.add("boom1", beam), boom2 = d.add("boom2", beam);
  auto law = d.add("law", law_block());
  auto late = d.add("late", late_block());
  mount(boom1, hub.child("C1"), Rotation::about(scenes::turn1, scenes::angle1));
  auto drive = hinge(d, "drive", boom2, hub.child("C2"),
                     Rotation::about(scenes::turn2, scenes::angle2), scenes::hinge_axis);
  drive.torque = scenes::kappa * drive.angle + scenes::c * drive.rate;
  law.in = hub.parent.position.angular();
  late.in = law.out;
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -T + gain * d.loop_point("torque", late.out);
  d.output("attitude", 3) = hub.parent.position.angular();
  return d;
}

/// L on paper: the law times the hub's angles per torque, 3 x 3.
by_hand::MatrixXcd loop_by_hand(const by_hand::Structure& a, by_hand::Complex s) {
  const by_hand::Complex C =
      (kp + kd * s) / (s / actuator + 1.0) * (1.0 - s * delay / 2.0) / (1.0 + s * delay / 2.0);
  return C * by_hand::position_transfer(a, s).block(3, 3, 3, 3);
}

/// Largest difference of L over a grid, relative, and of 1 + L, each axis alone, at its nearest
/// point to -1.
double loop_error(const ControlLoop& loop, const Margins& m, const by_hand::Structure& a) {
  double worst = 0;
  for (double w = 0.05; w < 200; w *= 1.1) {
    const by_hand::MatrixXcd L = loop_by_hand(a, {0, w});
    worst = std::max(worst, (loop.L.transfer({0, w}) - L).norm() / L.norm());
  }
  for (int i = 0; i < 3; ++i) {
    const LoopMargins& l = m.loops[static_cast<std::size_t>(i)];
    const by_hand::MatrixXcd S =
        (by_hand::MatrixXcd::Identity(3, 3) + loop_by_hand(a, {0, l.nearest.omega})).inverse();
    worst = std::max(worst, std::abs(std::abs(1.0 / S(i, i)) / l.nearest.value - 1));
  }
  return worst;
}

/// The law at equal steps: it reads the attitude and turns the hub back.
DiscreteModel sampled_law(double period) {
  const Lti law = law_block();
  return discretize({law.A,
                     law.B,
                     -law.C,
                     -law.D,
                     {"x1", "x2", "x3"},
                     {"attitude(1)", "attitude(2)", "attitude(3)"},
                     {"T(1)", "T(2)", "T(3)"}},
                    period, Discretization::tustin);
}

/// The attitude under a torque of 1 N m about z from time 0 on, with the loop of the diagram open.
Trajectory pushed(const System& satellite) {
  const DiscreteModel law = sampled_law(0.01);
  const Excitation push = Excitation::step(input_values(satellite, {{"T(3)", 1}}));
  return simulate(satellite.update({{"gain", 0}}), Excitation::sampled(law, push),
                  {.step = 0.005, .until = 60});
}

}  // namespace

int main() {
  const FlexibleBody beam = boom();
  const System system = compile(controlled(beam));
  const ControlLoop torque = loop(system, "torque");
  const Margins m = margins(torque);
  std::printf("%s", to_string(m).c_str());
  const by_hand::Structure by_hand = scenes::satellite_by_hand(beam.data());
  bool ok = m.stable && by_hand::agrees("L and its nearest points to -1, by hand",
                                        loop_error(torque, m, by_hand), 1e-8);

  const double allowed = std::min(
      {m.loops[0].larger_gain.value, m.loops[1].larger_gain.value, m.loops[2].larger_gain.value});
  const Margins twice = margins(loop(system.update({{"gain", 2 * allowed}}), "torque"));
  std::printf("\nat %.2f times the gain: %s", 2 * allowed, to_string(twice).c_str());
  ok &= !twice.stable && twice.nyquist.agree;

  const Trajectory t = pushed(system);
  std::printf("sampled 100 times a second: at rest after a push of 1 N m at %.6f rad\n",
              t.y(2, Eigen::last));
  ok &= by_hand::agrees("1 / kp", std::abs(t.y(2, Eigen::last) * kp - 1), 1e-6);

  write_plot(plot_nyquist(torque), "nyquist.svg");
  write_plot(plot_bode(torque.L, "torque(3)", "torque(3)"), "bode.svg");
  write_plot(plot_poles(system, {.band_hz = {0, 20}}), "poles.svg");
  return ok ? 0 : 1;
}
