/// Time responses: a boom on a hub is turned by 14.5 degrees with a torque of two pulses, recorded
/// as a table, then without torque. Three ways to step, and the error for a step that is too long.
#include <fmt/format.h>

#include <titop/titop.hpp>

using namespace titop;

namespace {

Diagram slewing_boom() {
  Diagram d{"slewing boom"};
  auto torque = d.input("torque", 3);  // [N m]
  auto hub = d.add("hub", RigidBody{.mass = 400,
                                    .inertia = Eigen::Vector3d(80, 90, 100).asDiagonal(),
                                    .children = {{"C", {1, 0, 0}}}});
  const FlexibleBody rod = Beam{.length = 8.0,
                                .section = rectangle(0.05, 0.05),
                                .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                .elements = 6,
                                .modes = {.kept = 8, .xi = {0.002}}};
  auto boom = d.add("boom", rod);
  mount(boom, hub.child("C"));
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -torque;
  d.output("attitude", 3) = hub.parent.position.angular();  // [rad]
  d.output("tip") = boom.child.accel.along({0, 1, 0});      // [m/s^2]
  return d;
}

}  // namespace

int main() {
  const System system = compile(slewing_boom());
  // [N m]: 20 s forwards, 20 s backwards; a jump is two equal times.
  Eigen::MatrixXd pulses = Eigen::MatrixXd::Zero(3, 6);
  pulses.row(2) << 1, 1, -1, -1, 0, 0;
  const Excitation slew = Excitation::recorded({0, 20, 20, 40, 40, 60}, pulses);

  fmt::print("{} states; torque about z +1, -1, 0 N m\n\n", system.order());
  fmt::print("   t [s]   attitude [mrad]   tip [mm/s^2]\n");
  const Trajectory exact = simulate(system, slew, {.step = 0.1, .until = 60});
  for (Eigen::Index k = 0; k <= 600; k += 100)
    fmt::print("{:8.1f} {:17.4f} {:14.4f}\n", exact.time[static_cast<std::size_t>(k)],
               1e3 * exact.y(2, k), 1e3 * exact.y(3, k));

  fmt::print("\nthe attitude at 60 s by other steps [mrad]:\n");
  const auto attitude = [&](Stepper stepper, double step) {
    return 1e3 * simulate(system, slew, {.step = step, .until = 60, .stepper = stepper})
                     .y(2, Eigen::last);
  };
  fmt::print("exact,    0.1 s   {:.6f}\n", attitude(Stepper::exact, 0.1));
  fmt::print("exact,    5 s     {:.6f}\n", attitude(Stepper::exact, 5));
  fmt::print("midpoint, 0.1 s   {:.6f}\n", attitude(Stepper::midpoint, 0.1));
  try {
    attitude(Stepper::rk4, 0.1);
  } catch (const Error& error) {
    fmt::print("\n{}\n", error.what());
  }
}
