#pragma once

#include <cmath>
#include <optional>

/// Times that are whole numbers of steps. For the library's own files.
namespace titop::detail {

/// Of a step: rounding of times that users type or add up.
inline constexpr double kOfStep = 1e-9;
inline constexpr double kMostSteps = 1e9;

/// time / step, not negative, if that is a whole number; 0 is one.
inline std::optional<double> whole_steps(double time, double step) {
  const double steps = time / step, whole = std::round(steps);
  if (std::abs(steps - whole) <= kOfStep * std::fmax(1, whole)) return whole;
  return std::nullopt;
}

}  // namespace titop::detail
