#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>
#include <titop/analysis/control/crossings.hpp>
#include <titop/analysis/control/feedback.hpp>
#include <titop/analysis/control/margins.hpp>
#include <titop/analysis/control/nyquist.hpp>
#include <titop/analysis/control/zeros.hpp>
#include <titop/analysis/norms/hinf.hpp>
#include <titop/analysis/norms/scaled.hpp>
#include <titop/compiler/minreal/minimize.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {
namespace {

using detail::LoopResponse;
using Eigen::MatrixXd;
using std::numbers::pi;

/// Least values, and where they are, of distances along the axis.
struct Distances {
  MarginAt nearest;  ///< of |1 + L|
  DiskMargin disk;   ///< alpha = 2 |1 + L| / |1 - L|
};

/// By norms: no delay.
Distances by_norms(const StateSpace& L) {
  StateSpace S = detail::sensitivity(L);
  const HinfNorm nearest = norm_hinf(S);
  S.C *= 2;
  S.D = 2 * S.D - MatrixXd::Identity(S.D.rows(), S.D.cols());  // S - T
  const HinfNorm disk = norm_hinf(S);
  const MarginAt inside{1 / nearest.value, nearest.omega};
  return {inside,
          disk.value > 1 ? DiskMargin{2 / disk.value, disk.omega} : DiskMargin{2, HUGE_VAL}};
}

/// The list without points that are equal to half the digits of the last, as crossings that are
/// found twice: between these, rounding would decide on which side a minimum is looked for.
std::vector<double> apart(std::vector<double> list) {
  const auto close = [](double a, double b) { return b - a <= linalg::kHalfDigits * b; };
  list.erase(std::unique(list.begin(), list.end(), close), list.end());
  return list;
}

/// The least f(omega) over the list and between its neighbours.
template <class F>
MarginAt least(const F& f, const std::vector<double>& list) {
  MarginAt best{HUGE_VAL, 0};
  std::vector<double> values;
  for (const double omega : list) values.push_back(f(omega));
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (values[i] < best.value) best = {values[i], list[i]};
    if (i == 0 || i + 1 == list.size() || values[i] > values[i - 1] || values[i] > values[i + 1])
      continue;
    // Over t, not omega: the tolerance of brent_find_minima is relative to its variable, and the
    // interval may be as narrow as a resonance.
    const auto omega = [&](double t) { return std::lerp(list[i - 1], list[i + 1], t); };
    const auto [part, value] =
        boost::math::tools::brent_find_minima([&](double t) { return f(omega(t)); }, 0.0, 1.0, 40);
    if (value < best.value) best = {value, omega(part)};
  }
  return best;
}

/// On a grid: of one loop with a delay, and no direct term.
Distances on_grid(const StateSpace& L, const LoopResponse& response,
                  const std::vector<LoopCrossing>& unit) {
  std::vector<std::complex<double>> roots = detail::all_poles(L);
  const Eigen::VectorXcd zeros = transmission_zeros(L);
  roots.insert(roots.end(), zeros.begin(), zeros.end());
  for (const LoopCrossing& c : unit) roots.emplace_back(0, c.omega);
  std::vector<double> list =
      apart(detail::structured(roots, 8 * response.delay(), detail::end_of_turns(response, roots)));
  list.insert(list.begin(), 0);
  const auto distance = [&](double w) { return std::abs(1.0 + response.at(w)); };
  const MarginAt nearest =
      least([&](double w) { return std::isfinite(distance(w)) ? distance(w) : HUGE_VAL; }, list);
  const MarginAt disk = least(
      [&](double w) {
        return std::isfinite(distance(w)) ? 2 * distance(w) / std::abs(1.0 - response.at(w)) : 2;
      },
      list);
  return {nearest.value < 1 ? nearest : MarginAt{1, HUGE_VAL},
          disk.value < 2 ? DiskMargin{disk.value, disk.omega} : DiskMargin{2, HUGE_VAL}};
}

void gain_margins(LoopMargins& m) {
  m.larger_gain = {HUGE_VAL, 0}, m.smaller_gain = {0, 0};
  for (const LoopCrossing& c : m.negative) {
    const double factor = 1 / std::abs(c.L);
    if (factor >= 1 && factor < m.larger_gain.value) m.larger_gain = {factor, c.omega};
    if (factor <= 1 && factor > m.smaller_gain.value) m.smaller_gain = {factor, c.omega};
  }
}

/// `direct`: |L| at infinite frequency. From 1 on, any delay turns L there past -1 again and again.
void phase_margins(LoopMargins& m, double direct) {
  m.phase = {HUGE_VAL, 0}, m.delay = {HUGE_VAL, 0};
  if (direct >= 1) m.delay = {0, HUGE_VAL};
  for (const LoopCrossing& c : m.unit) {
    const double ahead = std::arg(-c.L);  // of -1, from -pi to pi
    if (std::abs(ahead) < m.phase.value) m.phase = {std::abs(ahead), c.omega};
    const double lag = ahead < 0 ? ahead + 2 * pi : ahead;
    if (lag / c.omega < m.delay.value) m.delay = {lag / c.omega, c.omega};
  }
}

double nearest_with_delay(const StateSpace& L, double delay) {
  const LoopResponse response(L, delay);
  return on_grid(L, response, detail::unit_crossings(L, response)).nearest.value;
}

LoopMargins of_one(const StateSpace& L, double delay, bool stable, std::string name) {
  const LoopResponse response(L, delay);
  LoopMargins m;
  m.point = std::move(name);
  m.unit = detail::unit_crossings(L, response);
  m.negative = detail::negative_crossings(L, response);
  if (!stable) return m;
  gain_margins(m);
  phase_margins(m, std::abs(L.D(0, 0)));
  const Distances d = delay > 0 ? on_grid(L, response, m.unit) : by_norms(L);
  m.nearest = d.nearest, m.disk = d.disk;
  return m;
}

void check(const StateSpace& L, double delay) {
  require_fitting(L, "margins");
  if (L.D.rows() != L.D.cols() || L.D.rows() == 0)
    throw Error(Code::size,
                "margins of a model with " + std::to_string(L.D.cols()) + " inputs and " +
                    std::to_string(L.D.rows()) + " outputs",
                "a loop transfer is square: loop(system, \"name\").L");
  detail::require_finite(L, "margins");
  if (!(delay >= 0) || std::isinf(delay) || (delay > 0 && L.D.rows() > 1))
    throw Error(
        Code::bad_value,
        "a delay of " + std::to_string(delay) + " s in " + std::to_string(L.D.rows()) + " loops",
        "give MarginOptions::delay in seconds, 0 or more, and for one loop only; for "
        "several put Pade approximations into the diagram");
  if (delay > 0 && L.D(0, 0) != 0)
    throw Error(Code::bad_value, "a delay in a loop with a direct term",
                "give the actuator or the sensor its dynamics: without, the loop does not become "
                "small at high frequencies, and the delay turns it past -1 at all of them");
  if (L.order() > kMostStatesOfHinf)
    throw Error(Code::bad_value,
                "margins of a loop transfer of " + std::to_string(L.order()) + " states",
                "reduce it to " + std::to_string(kMostStatesOfHinf) +
                    " states or fewer: compile(diagram, Scene{...})");
}

std::string point_name(const StateSpace& L, int i) {
  return linalg::at(i) < L.outputs.size() ? L.outputs[linalg::at(i)]
                                          : "loop " + std::to_string(i + 1);
}

void add_warnings(Margins& m, const std::vector<Note>& notes) {
  for (const Note& n : notes)
    if (n.kind == Note::Kind::warning) m.warnings.push_back(n.pass + ": " + n.text);
}

}  // namespace

Margins detail::margins_of(const StateSpace& L, double delay, double period) {
  check(L, delay);
  Margins m;
  m.nyquist = nyquist_count(L, LoopResponse(L, delay), period);
  if (delay > 0 && nearest_with_delay(L, delay) <= linalg::kHalfDigits)
    m.nyquist.closed_on_axis = 1;
  m.stable = m.nyquist.closed_right == 0 && m.nyquist.closed_on_axis == 0 && m.nyquist.agree;
  const int count = static_cast<int>(L.D.rows());
  for (int i = 0; i < count; ++i)
    m.loops.push_back(of_one(count == 1 ? L : alone(L, i), delay, m.stable, point_name(L, i)));
  if (count == 1) {
    m.disk = m.loops[0].disk, m.nearest = m.loops[0].nearest;
  } else if (m.stable) {
    const Distances d = by_norms(L);
    m.disk = d.disk, m.nearest = d.nearest;
  }
  return m;
}

Margins margins(const StateSpace& L, const MarginOptions& options) {
  return detail::margins_of(L, options.delay, 0);
}

Margins margins(const ControlLoop& loop, const MarginOptions& options) {
  Margins m = margins(loop.L.state_space(), options);
  add_warnings(m, loop.L.notes());
  add_warnings(m, loop.L.dense_notes());
  return m;
}

}  // namespace titop
