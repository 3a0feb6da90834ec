#pragma once

#include <string>
#include <utility>
#include <vector>

namespace titop {

/// The values that a parameter may take.
struct ParameterRange {
  enum class Kind { percent, between, full_turn };
  Kind kind = Kind::percent;
  double first = 0, second = 0;  ///< the percentage; or the least and the largest value
};

/// Up to this many percent of the nominal value below and above it.
inline ParameterRange percent(double of_nominal) {
  return {ParameterRange::Kind::percent, of_nominal, 0};
}
/// From `least` to `largest`, with the nominal value inside; angles [rad] less than half a turn
/// from it.
inline ParameterRange between(double least, double largest) {
  return {ParameterRange::Kind::between, least, largest};
}
/// Every value of an angle, at twice as many occurrences.
inline ParameterRange full_turn() { return {ParameterRange::Kind::full_turn, 0, 0}; }

/// Parameters by name with their ranges: {{"m", percent(20)}, {"tilt", between(-1.2, 1.9)}}.
using ParameterRanges = std::vector<std::pair<std::string, ParameterRange>>;

/// From the value p of a parameter to delta in [-1, 1], and back. With the deviation
///
///     d = p - nominal,   of an angle   d = tan((p - nominal) / 2),   with full_turn   tan(... / 4)
///
/// it is the Moebius map delta = d / (gain - shape d), which is -1, 0 and 1 at the least, the
/// nominal and the largest value. `gain` has the unit of d, `shape` none.
struct ParameterMap {
  enum class Kind { number, half_angle, quarter_angle };
  Kind kind = Kind::number;
  double nominal = 0, from = 0, to = 0;
  double gain = 1, shape = 0;

  /// For the range [from, to] around `nominal`, which must be inside.
  ParameterMap(Kind kind, double nominal, double from, double to);
  double deviation(double p) const;  ///< d
  double delta(double p) const;      ///< in [-1, 1] for p in [from, to]
  double value(double delta) const;  ///< p
  /// Divisor of the deviation of an angle: 2 or 4; 0 for a number.
  int divisor() const;
};

/// "(m - 1000) / 200", or "Moebius of tan((tilt - 0.4) / 2)".
std::string to_string(const ParameterMap& map, const std::string& parameter);

}  // namespace titop
