// The demo's satellite as generated C++: examples/CMakeLists.txt calls titop_generate_model, which
// compiles the diagram during the build and writes satellite.hpp, all that a flight or simulation
// code needs, and satellite_test.cpp, which checks it. Here: a slew of the driven boom.
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "satellite.hpp"
#include "scenes/satellite.hpp"

namespace {

// Evaluated by the compiler: nothing is computed at start-up.
constexpr satellite::Input torque(double motor) {
  satellite::Input u{};
  u[satellite::in::tau_m] = motor;
  return u;
}
constexpr double kick =
    satellite::output(satellite::step({}, torque(1)), {})[satellite::out::theta];
static_assert(kick > 0, "the motor turns the joint forwards");

constexpr int steps = 400;

/// Torque of a bang-bang slew [N m].
double motor(int k) { return k < steps / 4 ? 2 : k < steps / 2 ? -2 : 0; }

}  // namespace

int main() {
  std::printf("generated: %zu states, %zu inputs, %zu outputs, step of %g s\n", satellite::n_states,
              satellite::n_inputs, satellite::n_outputs, satellite::sample_time);

  const titop::System system = titop::compile(demo_satellite());
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(satellite::n_inputs, steps);
  for (int k = 0; k < steps; ++k) u(satellite::in::tau_m, k) = motor(k);
  const Eigen::MatrixXd exact =
      titop::held_response(system.state_space(), satellite::sample_time, u);

  double off = 0;
  const double largest = exact.row(satellite::out::theta).cwiseAbs().maxCoeff();
  satellite::State x{};
  for (int k = 0; k < steps; ++k) {
    const satellite::Output y = satellite::output(x, torque(motor(k)));
    off = std::max(off, std::abs(y[satellite::out::theta] - exact(satellite::out::theta, k)));
    if (k % 50 == 0)
      std::printf("  t = %4.2f s  theta = %9.6f rad  tip 2 along z = %9.6f m/s^2\n",
                  k * satellite::sample_time, y[satellite::out::theta], y[satellite::out::tip2_3]);
    x = satellite::step(x, torque(motor(k)));
  }
  return by_hand::agrees("step against long double", off / largest, 1e-12) ? 0 : 1;
}
