#pragma once

#include <limits>
#include <numbers>
#include <titop/emit/report/subject.hpp>
#include <vector>

namespace titop::report {

inline constexpr double kTwoPi = 2 * std::numbers::pi;
/// Value of a gap in a curve.
inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Poles other than 0, from slow to fast [rad/s].
std::vector<Pole> moving(const std::vector<Pole>& poles);

/// The transfers; empty matrices if a frequency is a pole.
struct Sweep {
  std::vector<double> omega, hertz;
  std::vector<Eigen::MatrixXcd> G;
};

/// Over ReportOptions::band_hz, or from a tenth of the slowest pole to four times the fastest;
/// closer at lightly damped poles, and near those on the axis.
Sweep sweep(const Subject& subject);
/// Its frequencies alone [rad/s].
std::vector<double> sweep_frequencies(const Subject& subject);

}  // namespace titop::report
