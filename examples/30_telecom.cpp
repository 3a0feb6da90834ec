// A telecommunication satellite from its files to its flight code: yokes from finite-element data,
// wings of three panels, wheels, liquid and a law in one model; a small model of the structure for
// the frequencies of the loop; the law's margins, continuous and sampled; and the law as generated
// C++, which then holds the satellite at its sample times. Masses and the gyroscopic torque are
// compared with those assembled by hand.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/telecom.hpp"
#include "telecom_law.hpp"

using namespace titop;
using namespace scenes::telecom;
using by_hand::Matrix6;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Mass matrix about P of a body that is mounted at this place, turned about z.
Matrix6 at_hub(const Matrix6& D, const Vector3d& place, double turn) {
  const Matrix3d T = Eigen::Matrix3d{
      {std::cos(turn), -std::sin(turn), 0}, {std::sin(turn), std::cos(turn), 0}, {0, 0, 1}};
  const Matrix6 to = by_hand::tau(-place);
  return to.transpose() * by_hand::dual(T) * D * by_hand::dual(T).transpose() * to;
}

/// A body of this mass and inertia about its centre, which is at `centre` in the body's frame.
Matrix6 body(double mass, const Vector3d& inertia, const Vector3d& centre = Vector3d::Zero()) {
  Matrix6 D = Matrix6::Zero();
  D.diagonal() << Vector3d::Constant(mass), inertia;
  return by_hand::tau(-centre).transpose() * D * by_hand::tau(-centre);
}

/// The whole satellite without its wheels' rotation, about the hub's point P.
Matrix6 rigid_by_hand(const FlexibleBody& yoke) {
  Matrix6 D = body(1800, {1500, 900, 1700});
  const double a = panel.a, b = panel.b, m = a * b * panel.thickness * panel.material.rho;
  for (const double side : {1.0, -1.0}) {
    const double turn = side * std::numbers::pi / 2;
    D += at_hub(yoke.data().D_P, {0, 1.1 * side, 0.1}, turn);
    const Matrix6 D_panel = body(m, {m * b * b / 12, m * a * a / 12, m * (a * a + b * b) / 12});
    for (int i = 0; i < 3; ++i)  // the yoke is 1 m long
      D += at_hub(D_panel, {0, side * (1.1 + 1 + (i + 0.5) * a), 0.1}, turn);
  }
  D += at_hub(body(120, Vector3d::Zero()), {0, 0, -0.5}, 0);
  for (int i = 0; i < 3; ++i) {
    Vector3d inertia = Vector3d::Constant(wheel_transverse);
    inertia(i) = 0;  // it turns by itself
    D += at_hub(body(wheel_mass, inertia), {0.3, 0, 0.4}, 0);
  }
  return D;
}

/// Far below all modes: (J s^2 + H s)^-1, J of the free satellite, H of the momentum about y.
double rigid_error(const System& open, const FlexibleBody& yoke) {
  const Matrix6 D = rigid_by_hand(yoke);
  const Matrix3d J = D.bottomRightCorner<3, 3>() - D.bottomLeftCorner<3, 3>() *
                                                       D.topLeftCorner<3, 3>().inverse() *
                                                       D.topRightCorner<3, 3>();
  Matrix3d H = Matrix3d::Zero();  // J s^2 theta = T + h y x (s theta)
  H(0, 2) = -wheel_momentum, H(2, 0) = wheel_momentum;
  const double s = 1e-4;
  const Matrix3d expected = (J * s * s + H * s).inverse();
  const MatrixXd ours = open.transfer(s).real().leftCols(3);
  return (ours - expected).norm() / expected.norm();
}

/// The structure between the wheels' torques and the attitude, as a small model for the
/// frequencies at which the law acts.
ReducedSystem structure_for_law(const FlexibleBody& yoke) {
  return compile(satellite(yoke, 0), Scene{.inputs = {"command(1)", "command(2)", "command(3)"},
                                           .outputs = {"attitude(1)", "attitude(2)", "attitude(3)"},
                                           .band_hz = {0.01, 4},
                                           .accuracy = 1e-3});
}

/// The law around this model of the structure.
Diagram with_law(const StateSpace& structure) {
  Diagram d{"loop"};
  auto plant = d.add("structure", Lti{structure.A, structure.B, structure.C, structure.D});
  auto law = d.add("law", law_block());
  law.in = plant.out;
  plant.in = -d.loop_point("torque", law.out);
  return d;
}

/// L with the law as it runs on board, from the torques at one sample to those that it commands.
DiscreteModel sampled_loop(const StateSpace& structure) {
  StateSpace law = compile(telecom_attitude_law()).state_space();
  law.C *= -1, law.D *= -1;  // its output is the torque that the wheels exert
  return series(discretize(structure, period), discretize(law, period));
}

void print_margins(const char* name, const Margins& m) {
  std::printf("%s: %s\n", name, m.stable ? "stable" : "NOT stable");
  for (std::size_t i = 0; i < 3; ++i) {
    const LoopMargins& l = m.loops[i];
    std::printf("  %c: gain %.1f dB, phase %.1f deg, delay %.2f s, disk %.2f at %.2f rad/s\n",
                "xyz"[i], decibels(l.larger_gain.value), degrees(l.phase.value), l.delay.value,
                l.disk.alpha, l.disk.omega);
  }
}

/// L of the small model against that of the whole satellite, where the disk margins are.
double loop_error(const ControlLoop& small, const ControlLoop& whole, const Margins& m) {
  double worst = 0;
  for (const LoopMargins& l : m.loops) {
    const std::complex<double> s{0, l.disk.omega};
    const by_hand::MatrixXcd L = whole.L.transfer(s);
    worst = std::max(worst, (small.L.transfer(s) - L).norm() / L.norm());
  }
  return worst;
}

/// Attitude under a torque of 0.1 N m about each axis from time 0 on, with the law as on board: by
/// the generated code, around the satellite as it is at the sample times.
MatrixXd by_flight_code(const System& open, int steps) {
  const StateSpace& plant = open.state_space();
  const Hold held = hold(plant.A, plant.B, period);
  VectorXd x = VectorXd::Zero(plant.order()), u = VectorXd::Constant(6, 0.1);
  MatrixXd attitude(3, steps + 1);
  telecom_law::State state{};
  for (int k = 0; k <= steps; ++k) {
    attitude.col(k) = plant.C * x;
    telecom_law::Input measured{};
    for (int i = 0; i < 3; ++i) measured[static_cast<std::size_t>(i)] = attitude(i, k);
    const telecom_law::Output torque = telecom_law::output(state, measured);
    for (int i = 0; i < 3; ++i) u(3 + i) = torque[static_cast<std::size_t>(i)];
    state = telecom_law::step(state, measured);
    x = held.A * x + held.B * u;
  }
  return attitude;
}

/// The same by `simulate` with the discrete law.
MatrixXd by_simulation(const System& open, int steps) {
  const DiscreteModel law = discretize(compile(telecom_attitude_law()).state_space(), period);
  const VectorXd torque = input_values(open, {{"T(1)", 0.1}, {"T(2)", 0.1}, {"T(3)", 0.1}});
  return simulate(open, Excitation::sampled({law.model, law.period}, Excitation::step(torque)),
                  {.step = period, .until = steps * period})
      .y;
}

}  // namespace

int main() {
  const FlexibleBody yoke = read_yoke();
  const System system = compile(satellite(yoke), {.minimize_up_to = 0});
  const System open = system.update({{"gain", 0.0}});
  std::printf("yoke from its file: %.2f kg, first mode %.2f Hz clamped\n", yoke.data().D_P(0, 0),
              yoke.data().omega(0) / (2 * std::numbers::pi));
  std::printf("satellite with its law: %d states; ", system.order());
  bool ok = by_hand::agrees("inertia and momentum by hand", rigid_error(open, yoke), 1e-6);

  const ReducedSystem small = structure_for_law(yoke);
  const ControlLoop torque = loop(compile(with_law(small.state_space())), "torque");
  const Margins m = margins(torque), sampled = margins(sampled_loop(small.state_space()));
  std::printf("structure from 0.01 to 4 Hz: %d states\n", small.order());
  print_margins("the law", m);
  print_margins("the law every 0.1 s", sampled);
  ok &= m.stable && m.nyquist.agree && sampled.stable;
  ok &= by_hand::agrees("L of the whole satellite there",
                        loop_error(torque, loop(system, "torque"), m), 1e-2);

  const int steps = 3000;
  const MatrixXd attitude = by_flight_code(open, steps), expected = by_simulation(open, steps);
  std::printf("flight code: %zu states, every %.1f s\n", telecom_law::n_states,
              telecom_law::sample_time);
  for (const int k : {100, 300, 1000, 3000})
    std::printf("  t = %3.0f s  %5.2f %5.2f %5.2f mrad\n", k * period, 1e3 * attitude(0, k),
                1e3 * attitude(1, k), 1e3 * attitude(2, k));
  ok &= by_hand::agrees("simulate with the discrete law",
                        (attitude - expected).norm() / expected.norm(), 1e-8);
  const VectorXd rest = attitude.col(steps).array() * kp.array() / 0.1;
  ok &= by_hand::agrees("torque / kp at rest", (rest.array() - 1).abs().maxCoeff(), 1e-3);
  return ok ? 0 : 1;
}
