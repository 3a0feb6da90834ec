#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/minreal/effect.hpp>
#include <titop/compiler/solve/frequency.hpp>
#include <titop/graph/error.hpp>

namespace titop::minreal {
namespace {

using Eigen::MatrixXcd;

OrderVerdict back_to(int order, double judged, OrderVerdict v) {
  v.order = v.highest = order;
  v.undecided.insert(v.undecided.end(), v.removed.begin(), v.removed.end());
  v.removed.clear();
  v.to_fewer = std::min(v.to_fewer, v.to_more);
  v.to_more = 0;
  if (v.change <= 100 * judged)
    v.change = -1;  // rounding
  else if (!v.exact)
    v.lowest = 0;  // the modes that stayed were judged in the same way
  return v;
}

/// Relative change of the transfer; 1 if a model has none.
double change(const StateSpace& whole, const StateSpace& part,
              const std::vector<std::complex<double>>& points) try {
  const std::vector<MatrixXcd> before = detail::refined_transfers(whole, points),
                               after = detail::refined_transfers(part, points);
  const detail::Measure by{std::vector<int>(whole.outputs.size(), 1),
                           std::vector<int>(whole.inputs.size(), 1),
                           detail::terms(whole, points).cwiseMax(detail::terms(part, points))};
  return detail::difference(after, before, by).relative;
} catch (const Error& error) {
  if (!error.has(Code::singular)) throw;
  return 1;
}

}  // namespace

std::vector<std::complex<double>> near_modes(std::vector<JudgedMode> modes,
                                             std::complex<double> s) {
  constexpr double kBelow = 1e-3;
  const auto integrators = std::stable_partition(modes.begin(), modes.end(),
                                                 [](const JudgedMode& m) { return m.omega > 0; });
  if (integrators != modes.end()) {
    modes.erase(integrators, modes.end());
    std::vector<std::complex<double>> points{s, kBelow * s};
    if (modes.empty()) return points;
    const auto others = near_modes(modes, s);
    points.insert(points.end(), others.begin(), others.end());
    return points;
  }
  std::sort(modes.begin(), modes.end(),
            [](const JudgedMode& a, const JudgedMode& b) { return a.omega < b.omega; });
  const auto most = std::max_element(
      modes.begin(), modes.end(),
      [](const JudgedMode& a, const JudgedMode& b) { return a.visibility < b.visibility; });
  std::vector<std::complex<double>> points;
  for (const double omega :
       {modes.front().omega, modes[modes.size() / 2].omega, modes.back().omega, most->omega})
    points.emplace_back(0.1 * omega, omega);
  return points;
}

void measure_change(const StateSpace& whole, Minimized& m) {
  if (m.order.removed.empty() || whole.inputs.empty() || whole.outputs.empty()) return;
  const double frequency = detail::frequency_of(whole.A),
               w = frequency > 0 && std::isfinite(frequency) ? frequency : 1;
  const auto points = near_modes(m.order.removed, detail::off_axis(w));
  m.order.change = change(whole, m.model, points);
  m.notes.front() = to_string(m.order);
}

bool put_back(const StateSpace& whole, double resolution, double lost, Minimized& m) {
  const double change = m.order.change, allowed = std::max(detail::kUnchanged, 10 * resolution);
  if (!(change > allowed) && !(lost > allowed)) return false;
  m.model = whole;
  m.order = back_to(whole.order(), std::max(detail::kUnchanged, resolution), std::move(m.order));
  m.notes = {
      to_string(m.order),
      change > allowed
          ? fmt::format("nothing was removed, because that changes the transfer by {:.1e}", change)
          : fmt::format("nothing was removed: the smaller model cancels more, and keeps "
                        "{:.0f} digits of the transfer",
                        std::max(0.0, -std::log10(lost)))};
  return true;
}

}  // namespace titop::minreal
