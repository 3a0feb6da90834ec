#include <algorithm>
#include <cmath>
#include <titop/emit/report/sweep.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::report {
namespace {

/// Lowest and highest frequency shown [rad/s].
std::pair<double, double> band(const Subject& s) {
  const auto [low, high] = s.options.band_hz;
  if (high > 0) return {kTwoPi * low, kTwoPi * high};
  const std::vector<Pole> list = moving(s.poles);
  if (list.empty()) return {kTwoPi * 0.01, kTwoPi * 100};
  return {list.front().omega / 10, 4 * list.back().omega};
}

/// Frequencies [rad/s]: logarithmic, closer at lightly damped poles, and near those on the axis.
std::vector<double> grid(const Subject& s) {
  const auto [low, high] = band(s);
  std::vector<double> list;
  constexpr int points = 500;
  for (int i = 0; i < points; ++i) {
    const double part = i / (points - 1.0);
    list.push_back(std::clamp(std::pow(low, 1 - part) * std::pow(high, part), low, high));
  }
  const auto add = [&list, lowest = low, highest = high](double omega) {
    if (omega >= lowest && omega <= highest) list.push_back(omega);
  };
  constexpr double kNarrowest = 1e-3;  // of the frequency: points around narrower peaks
  std::size_t refined = 0;
  for (const Pole& p : s.poles) {
    if (!p.pair || p.damping > 0.1 || p.omega < low || p.omega > high || ++refined > 150) continue;
    const double width = std::max(std::abs(p.damping), kNarrowest);
    for (const double k : {0.0, 0.3, 0.7, 1.0, 1.5, 2.5, 5.0, 10.0})
      for (const double sign : {-1.0, 1.0})
        if (k > 0 || (sign > 0 && std::abs(p.damping) > linalg::kPoleOnAxis))
          add(p.omega * (1 + sign * k * width));
  }
  detail::keep_each_once(list);
  return list;
}

Eigen::MatrixXcd transfer_or_none(const System& system, double omega) {
  try {
    return system.transfer({0, omega});
  } catch (const Error& error) {
    if (!error.has(Code::singular)) throw;
    return {};
  }
}

}  // namespace

std::vector<Pole> moving(const std::vector<Pole>& poles) {
  constexpr double kAtRest = 1e-9;  // of the fastest pole: a free motion beside rounding
  std::vector<Pole> list;
  const double fastest = poles.empty() ? 0 : poles.back().omega;
  for (const Pole& p : poles)
    if (p.omega > kAtRest * fastest) list.push_back(p);
  return list;
}

std::vector<double> sweep_frequencies(const Subject& s) { return grid(s); }

Sweep sweep(const Subject& s) {
  Sweep result;
  result.omega = grid(s);
  for (const double w : result.omega) result.hertz.push_back(w / kTwoPi);
  try {
    result.G = s.system.frequency_response(result.omega);
  } catch (const Error& error) {
    if (!error.has(Code::singular)) throw;
    result.G.resize(result.omega.size());
    for (std::size_t i = 0; i < result.omega.size(); ++i)
      result.G[i] = transfer_or_none(s.system, result.omega[i]);
  }
  return result;
}

}  // namespace titop::report
