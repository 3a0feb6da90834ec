#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <titop/analysis/control/response.hpp>

namespace titop {
double decibels(double gain) { return 20 * std::log10(gain); }

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

std::vector<double> decibels(std::span<const std::complex<double>> values) {
  std::vector<double> result;
  for (const auto& value : values) result.push_back(decibels(std::abs(value)));
  return result;
}

/// Angles of real numbers beside rounding of 1e-12 of their terms [deg].
constexpr double kHalfTurn = 1e-10;

std::vector<double> degrees(std::span<const std::complex<double>> values) {
  std::vector<double> result;
  double last = -90;
  for (const auto& value : values) {
    if (!std::isfinite(std::abs(value)) || value == 0.0) {
      result.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    double now = degrees(std::arg(value));
    now += 360 * std::floor((last - now) / 360 + 0.5);
    if (std::abs(now - last) > 180 - kHalfTurn) {
      const double other = now > last ? now - 360 : now + 360;
      const double nearer = std::abs(now + 90) - std::abs(other + 90);
      if (nearer > kHalfTurn || (nearer > -kHalfTurn && other > now)) now = other;
    }
    result.push_back(last = now);
  }
  return result;
}

BodeResponse bode(const System& system, const std::string& output, const std::string& input,
                  std::span<const double> omega) {
  const int row = system.output(output), column = system.input(input);
  std::vector<std::complex<double>> values;
  for (const Eigen::MatrixXcd& G : system.frequency_response(omega))
    values.push_back(G(row, column));
  return {{omega.begin(), omega.end()}, decibels(values), degrees(values)};
}

Eigen::VectorXd input_values(const System& system, const ParameterList& values) {
  Eigen::VectorXd u = Eigen::VectorXd::Zero(std::ssize(system.inputs()));
  std::vector<int> set;
  for (const auto& [name, value] : values) {
    const int i = system.input(name);
    if (std::find(set.begin(), set.end(), i) != set.end())
      throw Error(Code::duplicate_name, "input " + name + " is given twice",
                  "give each input one value");
    set.push_back(i);
    u(i) = value;
  }
  return u;
}

}  // namespace titop
