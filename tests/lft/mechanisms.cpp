#include <doctest/doctest.h>
#include <fmt/format.h>

#include "../../examples/scenes/solar_array_drive.hpp"

/// Parameters of mechanisms: occurrences, and closing against update.

using namespace titop;

// The gear multiplies the drive's acceleration, its detent's spring and damper together, and the
// torque; with the motor's angle as a coordinate it would occur twice.
TEST_CASE("a solar array drive: the motor's inertia occurs once, the gear three times") {
  using scenes::solar_array_drive::ArrayDrive;
  const System system = compile(scenes::solar_array_drive::satellite());
  const Lft f = lft(system, {{"tilt", between(-1, 1)}, {"N", percent(20)}, {"J_m", percent(30)}});
  INFO(to_string(f), " margin ", f.rank_margin().kept, " ", f.rank_margin().dropped);
  for (const Delta& d : f.deltas()) {
    CAPTURE(d.parameter);
    CHECK(d.size <= (d.parameter == "J_m" ? 1 : d.parameter == "N" ? 3 : 8));
    CHECK(d.at_least >= (d.parameter == "J_m" ? 1 : 2));
  }
  for (const ArrayDrive& design : {ArrayDrive{.tilt = 0.7, .gear = 85, .motor_inertia = 2.5e-5},
                                   ArrayDrive{.tilt = -0.9, .gear = 119, .motor_inertia = 1.5e-5}})
    for (const std::complex<double> s : {std::complex<double>(0.2, 1.7), {1, 20}}) {
      const Eigen::MatrixXcd right = system.update(design.list()).transfer(s);
      CHECK((f.at(design.list()).transfer(s) - right).norm() <= 1e-11 * right.norm());
    }
}
