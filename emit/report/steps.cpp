#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <titop/analysis/simulation/simulate.hpp>
#include <titop/emit/report/figures.hpp>
#include <titop/emit/report/plot.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::report {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

/// The next 1, 2 or 5 times a power of ten.
double round_up(double t) {
  const double unit = std::pow(10.0, std::floor(std::log10(t)));
  for (const double k : {1.0, 2.0, 5.0})
    if (t <= k * unit * (1 + 1e-12)) return k * unit;
  return 10 * unit;
}

struct TimeGrid {
  double until = 1;
  int steps = 500;
  bool coarse = false;  ///< the fastest modes turn between steps
};

/// Eight periods of the slowest oscillation, six time constants of the slowest decay, at most eight
/// of the fastest growth.
TimeGrid time_grid(const Subject& s) {
  TimeGrid c;
  double swing = 0, decay = 0, grow = 0;
  const std::vector<Pole> list = moving(s.poles);
  for (const Pole& p : list) {
    if (p.pair) swing = std::max(swing, 8 * kTwoPi / p.omega);
    if (!p.pair && p.s.real() < 0) decay = std::max(decay, -6 / p.s.real());
    grow = std::max(grow, p.s.real() > 1e-9 * p.omega ? p.s.real() : 0);
  }
  double until = std::max(swing, swing > 0 ? std::min(decay, 10 * swing) : decay);
  if (grow > 0) until = std::min(until > 0 ? until : HUGE_VAL, 8 / grow);
  c.until = s.options.until > 0 ? s.options.until : until > 0 ? round_up(until) : 1;
  const double fastest = list.empty() ? 0 : list.back().omega;
  const double wanted = c.until * fastest / kTwoPi * 12;
  c.steps = static_cast<int>(std::clamp(wanted, 500.0, 5000.0));
  c.coarse = wanted > 5000;
  return c;
}

/// Responses to a unit step on one input.
struct Steps {
  std::vector<double> time;
  std::map<int, MatrixXd> of;  ///< per input: outputs x times
  Stepper stepper = Stepper::exact;
  double error = 0;  ///< of all outputs, see Trajectory::error
};

Steps steps(const Subject& s, const std::vector<IoPair>& pairs, const TimeGrid& c) {
  Steps result;
  for (const IoPair& p : pairs) {
    if (result.of.count(p.input)) continue;
    VectorXd u = VectorXd::Zero(static_cast<Index>(s.inputs.size()));
    u(p.input) = 1;
    const Trajectory t = simulate(
        s.system, Excitation::step(u),
        {.step = c.until / c.steps, .until = c.until, .accuracy = HUGE_VAL});  // in the report
    result.time = t.time;
    result.stepper = t.stepper;
    if (t.error.size() > 0) result.error = std::max(result.error, t.error.maxCoeff());
    result.of[p.input] = t.y;
  }
  return result;
}

/// Of steps by the matrix exponential: of A, B, C, D, whose entries are rounded.
std::string exact_text(double error) {
  constexpr double kNone = 1e-9;
  if (error <= kNone) return "by the matrix exponential: exact at every step.";
  return fmt::format(
      "by the matrix exponential of A, B, C, D, whose rounding changes the outputs by up to {:.1e} "
      "of their largest values.",
      error);
}

/// If the start is far larger than the rest, the frame shows the rest, and the caption gives the
/// start's range.
void cut_start(Plot& plot) {
  double low = HUGE_VAL, high = -HUGE_VAL, rest_low = HUGE_VAL, rest_high = -HUGE_VAL;
  for (std::size_t c = 0; c < plot.x_data.size(); ++c)
    for (std::size_t i = 0; i < plot.x_data[c].size(); ++i) {
      const double y = plot.frames.front().curves[c][i];
      low = std::min(low, y), high = std::max(high, y);
      if (plot.x_data[c][i] > 0.02 * plot.x.high)
        rest_low = std::min(rest_low, y), rest_high = std::max(rest_high, y);
    }
  const double span = rest_high - rest_low;
  if (!(span > 0) || high - low < 8 * span) return;
  plot.frames.front().y.low = rest_low - 0.15 * span;
  plot.frames.front().y.high = rest_high + 0.15 * span;
  plot.caption = fmt::format("Outside the frame the start goes from {:.3g} to {:.3g} {}.", low,
                             high, plot.frames.front().y.unit);
}

Plot step_plot(const Subject& s, const Steps& all, const std::vector<IoPair>& pairs) {
  const ScalarSignal& input = s.inputs[at(pairs.front().input)];
  const ScalarSignal& output = s.outputs[at(pairs.front().output)];
  Plot plot{.title = fmt::format("{} [{}] to a step of 1 {} on {}",
                                 pairs.size() == 1 ? output.signal : "outputs",
                                 or_users(output.unit), or_users(input.unit), input.signal),
            .caption = {},
            .x = {.label = "time", .unit = "s"},
            .labels = {},
            .x_data = {},
            .frames = {{.y = {.label = "response", .unit = or_users(output.unit)},
                        .curves = {},
                        .height = 200}}};
  plot.x.high = all.time.back();
  for (const IoPair& p : pairs) {
    const auto row = all.of.at(p.input).row(p.output);
    plot.labels.push_back(
        fmt::format("{}, step on {}", s.outputs[at(p.output)].name, s.inputs[at(p.input)].name));
    plot.x_data.push_back(all.time);
    plot.frames.front().curves.emplace_back(row.begin(), row.end());
  }
  cut_start(plot);
  return plot;
}

}  // namespace

Plot step_plot(const Subject& s, const std::vector<IoPair>& pairs) {
  return step_plot(s, steps(s, pairs, time_grid(s)), pairs);
}

std::string step_plots(const Subject& s, const std::vector<IoPair>& pairs) {
  auto figures = by_figure(s, pairs);
  const std::size_t count = figures.size();
  figures.resize(std::min(count, kFigures));
  std::vector<IoPair> shown;
  for (const auto& f : figures) shown.insert(shown.end(), f.begin(), f.end());
  const TimeGrid c = time_grid(s);
  const Steps all = steps(s, shown, c);
  std::string text = fmt::format(
      "<p>All states at rest, then a unit step at time 0. {} steps of {:.4g} s, {}{}</p>\n"
      "<div class=\"figures\">\n",
      c.steps, c.until / c.steps,
      all.stepper == Stepper::exact
          ? exact_text(all.error)
          : fmt::format(
                "by the implicit midpoint rule through the factors, of half that size: steps "
                "of twice the size change the outputs by up to {:.1e} of their largest "
                "values.",
                all.error),
      c.coarse ? " The fastest modes turn more than once in twelve steps: the plots show their "
                 "range, not every swing."
               : "");
  for (const auto& f : figures) text += figure(step_plot(s, all, f));
  return text + "</div>\n" + left_out(count, "ask for pairs by ReportOptions::pairs");
}

}  // namespace titop::report
