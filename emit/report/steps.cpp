#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <titop/analysis/simulation/simulate.hpp>
#include <titop/emit/report/figures.hpp>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/plot.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::report {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

/// Two values of one number, computed in two ways, are at least this much of each other.
constexpr double kNearly = 1 - 1e-9;

/// The next 1, 2 or 5 times a power of ten.
double round_up(double t) {
  const double unit = std::pow(10.0, std::floor(std::log10(t)));
  for (const double k : {1.0, 2.0, 5.0})
    if (t * kNearly <= k * unit) return k * unit;
  return 10 * unit;
}

/// How much of a step response belongs to a pole. On the positive real axis G(s) is the mean of the
/// response over a time 1 / s: without resonances, and with a step at the modulus of each pole that
/// takes part.
class Shares {
 public:
  explicit Shares(const Subject& s) {
    const std::vector<Pole> poles = moving(s.poles);
    if (poles.empty()) return;
    const double low = poles.front().omega / kAround, high = poles.back().omega * kAround;
    const double decades = std::log10(high / low);
    const int count = static_cast<int>(std::min(10 * decades, 300.0)) + 2;
    for (int i = 0; i < count; ++i) {
      const double at = low * std::pow(10.0, decades * i / (count - 1));
      try {
        G_.push_back(s.system.transfer(at).real());
        s_.push_back(at);
      } catch (const Error& error) {  // a pole on the right
        if (!error.has(Code::singular)) throw;
      }
    }
  }

  /// The change of G around the pole, relative to the largest |G|; 0 to 2.
  double of(const Pole& p, const IoPair& pair) const {
    double low = HUGE_VAL, high = -HUGE_VAL, largest = 0;
    for (std::size_t i = 0; i < s_.size(); ++i) {
      const double g = G_[i](pair.output, pair.input);
      largest = std::max(largest, std::abs(g));
      if (s_[i] < p.omega / kAround * kNearly || s_[i] > p.omega * kAround / kNearly) continue;
      low = std::min(low, g), high = std::max(high, g);
    }
    return largest > 0 && high > low ? (high - low) / largest : 0;
  }

 private:
  static constexpr double kAround = 4;
  std::vector<double> s_;
  std::vector<MatrixXd> G_;
};

struct TimeGrid {
  double until = 1;
  int steps = 500;
  bool coarse = false;  ///< the fastest modes turn between steps
};

/// The poles that have an eighth of one of these responses; all of them, if none has.
std::vector<Pole> shown_poles(const Subject& s, const Shares& shares,
                              const std::vector<IoPair>& pairs) {
  constexpr double kPart = 0.125;
  const std::vector<Pole> all = moving(s.poles);
  std::vector<Pole> shown;
  std::copy_if(all.begin(), all.end(), std::back_inserter(shown), [&](const Pole& p) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const IoPair& pair) { return shares.of(p, pair) >= kPart; });
  });
  return shown.empty() ? all : shown;
}

/// Of the poles that these responses show eight periods of the slowest oscillation and six time
/// constants of the slowest decay; of all poles at most eight of the fastest growth.
TimeGrid time_grid(const Subject& s, const Shares& shares, const std::vector<IoPair>& pairs) {
  TimeGrid c;
  double swing = 0, decay = 0, grow = 0;
  for (const Pole& p : shown_poles(s, shares, pairs)) {
    if (p.pair) swing = std::max(swing, 8 * kTwoPi / p.omega);
    if (!p.pair && p.s.real() < 0) decay = std::max(decay, -6 / p.s.real());
  }
  const std::vector<Pole> all = moving(s.poles);
  for (const Pole& p : all)
    grow = std::max(grow, p.s.real() > linalg::kPoleOnAxis * p.omega ? p.s.real() : 0);
  double until = std::max(swing, swing > 0 ? std::min(decay, 10 * swing) : decay);
  if (grow > 0) until = std::min(until > 0 ? until : HUGE_VAL, 8 / grow);
  c.until = s.options.until > 0 ? s.options.until : until > 0 ? round_up(until) : 1;
  const double fastest = all.empty() ? 0 : all.back().omega;
  const double wanted = c.until * fastest / kTwoPi * 12;
  c.steps = static_cast<int>(std::clamp(wanted, 500.0, 5000.0));
  c.coarse = wanted > 5000;
  return c;
}

/// The responses to a unit step on one input, to the end of the time grid.
struct Step {
  std::vector<double> time;
  MatrixXd y;  ///< outputs x times
};

/// Simulations, one for each input and end.
struct Steps {
  const Subject& subject;
  std::map<std::pair<int, double>, Step> done = {};
  Stepper stepper = Stepper::exact;
  double error = 0;  ///< of all outputs, see Trajectory::error

  const Step& of(int input, const TimeGrid& c) {
    const auto [place, isnew] = done.try_emplace({input, c.until});
    if (!isnew) return place->second;
    VectorXd u = VectorXd::Zero(static_cast<Index>(subject.inputs.size()));
    u(input) = 1;
    Trajectory t = simulate(
        subject.system, Excitation::step(u),
        {.step = c.until / c.steps, .until = c.until, .accuracy = HUGE_VAL});  // in the report
    stepper = t.stepper;
    if (t.error.size() > 0) error = std::max(error, t.error.maxCoeff());
    return place->second = {std::move(t.time), std::move(t.y)};
  }
};

/// Of steps by the matrix exponential: of A, B, C, D, whose entries are rounded.
std::string exact_text(double error) {
  constexpr double kNone = 1e-9;
  if (error <= kNone) return "by the matrix exponential: exact at every step.";
  return fmt::format(
      "by the matrix exponential of A, B, C, D, whose rounding changes the outputs by up to {} of "
      "their largest values.",
      number(error, 2));
}

std::string method(const Steps& all) {
  if (all.stepper == Stepper::exact) return exact_text(all.error);
  return fmt::format(
      "by the implicit midpoint rule through the factors: steps of twice the size change the "
      "outputs by up to {} of their largest values.",
      number(all.error, 2));
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

Plot step_plot(const Subject& s, Steps& all, const TimeGrid& c, const std::vector<IoPair>& pairs) {
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
  plot.x.high = c.until;
  for (const IoPair& p : pairs) {
    const Step& step = all.of(p.input, c);
    const auto row = step.y.row(p.output);
    plot.labels.push_back(
        fmt::format("{}, step on {}", s.outputs[at(p.output)].name, s.inputs[at(p.input)].name));
    plot.x_data.push_back(step.time);
    plot.frames.front().curves.emplace_back(row.begin(), row.end());
  }
  cut_start(plot);
  return plot;
}

}  // namespace

Plot step_plot(const Subject& s, const std::vector<IoPair>& pairs) {
  Steps all{s};
  return step_plot(s, all, time_grid(s, Shares(s), pairs), pairs);
}

std::string step_plots(const Subject& s, const std::vector<IoPair>& pairs) {
  auto figures = by_figure(s, pairs);
  const std::size_t count = figures.size();
  figures.resize(std::min(count, kFigures));
  const Shares shares(s);
  Steps all{s};
  std::string drawn;
  bool coarse = false;
  for (const auto& f : figures) {
    const TimeGrid c = time_grid(s, shares, f);
    drawn += figure(step_plot(s, all, c, f));
    coarse = coarse || c.coarse;
  }
  const std::string end = s.options.until > 0
                              ? fmt::format("until {} s", number(s.options.until))
                              : "until the modes with an eighth of the response have turned eight "
                                "times or decayed";
  return fmt::format(
             "<p>All states at rest, then a unit step at time 0, {}; {}{}</p>\n<div "
             "class=\"figures\">\n{}</div>\n",
             end, method(all),
             coarse ? " The fastest modes turn more than once in twelve steps: the plots show "
                      "their range, not every swing."
                    : "",
             drawn) +
         left_out(count, "ask for pairs by ReportOptions::pairs");
}

}  // namespace titop::report
