#pragma once

#include <cmath>
#include <titop/blocks/fe/scaled.hpp>

namespace titop::generate {

/// Factors of the numbers when the units change: a length of 2 becomes 2 * length, and so on.
using Units = DataUnits;

/// Exponents of a quantity in length, mass and time.
struct Dim {
  int length = 0, mass = 0, time = 0;
  double factor(const Units& u) const {
    return std::pow(u.length, length) * std::pow(u.mass, mass) * std::pow(u.time, time);
  }
};
inline constexpr Dim kForce{1, 1, -2}, kTorque{2, 1, -2}, kAccel{1, 0, -2}, kAngularAccel{0, 0, -2},
    kLength{1, 0, 0}, kAngle{0, 0, 0}, kRate{0, 0, -1}, kMass{0, 1, 0};

}  // namespace titop::generate
