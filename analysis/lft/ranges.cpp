#include <fmt/format.h>

#include <cmath>
#include <titop/analysis/lft/ranges.hpp>

namespace titop {
int ParameterMap::divisor() const {
  return kind == Kind::number ? 0 : kind == Kind::half_angle ? 2 : 4;
}

ParameterMap::ParameterMap(Kind k, double n, double least, double largest)
    : kind(k), nominal(n), from(least), to(largest) {
  const double a = deviation(from), b = deviation(to);
  shape = -(a + b) / (b - a);
  gain = -2 * a * b / (b - a);
}

double ParameterMap::deviation(double p) const {
  return kind == Kind::number ? p - nominal : std::tan((p - nominal) / divisor());
}

double ParameterMap::delta(double p) const {
  const double d = deviation(p);
  return d / (gain - shape * d);
}

double ParameterMap::value(double delta) const {
  const double d = gain * delta / (1 + shape * delta);
  return kind == Kind::number ? nominal + d : nominal + divisor() * std::atan(d);
}

std::string to_string(const ParameterMap& map, const std::string& name) {
  const std::string shifted = map.nominal < 0 ? fmt::format("({} + {:.6g})", name, -map.nominal)
                                              : fmt::format("({} - {:.6g})", name, map.nominal);
  const std::string d = map.kind == ParameterMap::Kind::number
                            ? shifted
                            : fmt::format("tan({} / {})", shifted, map.divisor());
  constexpr double kSymmetric = 1e-12;  // rounding of a range given in percent
  if (std::abs(map.shape) <= kSymmetric) return fmt::format("{} / {:.6g}", d, map.gain);
  return fmt::format("Moebius of {}", d);
}

}  // namespace titop
