#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <titop/compiler/emit/report/plot.hpp>
#include <titop/compiler/emit/report/subject.hpp>
#include <titop/compiler/simulate.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop::report {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTwoPi = 2 * std::numbers::pi, kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFigures = 12;  ///< of one kind; more are counted
constexpr std::size_t kCurves = 4;    ///< in one frame

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Poles beside 0, from slow to fast [rad/s].
std::vector<Pole> moving(const std::vector<Pole>& poles) {
  std::vector<Pole> list;
  const double fastest = poles.empty() ? 0 : poles.back().omega;
  for (const Pole& p : poles)
    if (p.omega > 1e-9 * fastest) list.push_back(p);
  return list;
}

/// Lowest and highest frequency shown [rad/s].
std::pair<double, double> band(const Subject& s) {
  const auto [low, high] = s.options.band_hz;
  if (high > 0) return {kTwoPi * low, kTwoPi * high};
  const std::vector<Pole> list = moving(s.poles);
  if (list.empty()) return {kTwoPi * 0.01, kTwoPi * 100};
  return {list.front().omega / 10, 4 * list.back().omega};
}

/// Frequencies [rad/s]: logarithmic, closer at lightly damped poles, beside those on the axis.
std::vector<double> grid(const Subject& s) {
  const auto [low, high] = band(s);
  std::vector<double> list;
  constexpr int points = 500;
  for (int i = 0; i < points; ++i) list.push_back(low * std::pow(high / low, i / (points - 1.0)));
  std::size_t refined = 0;
  for (const Pole& p : s.poles) {
    if (!p.pair || p.damping > 0.1 || p.omega < low || p.omega > high || ++refined > 150) continue;
    const double width = std::max(std::abs(p.damping), 1e-3);
    for (const double k : {0.0, 0.3, 0.7, 1.0, 1.5, 2.5, 5.0, 10.0})
      for (const double sign : {-1.0, 1.0})
        if (k > 0 || (sign > 0 && std::abs(p.damping) > 1e-6))
          list.push_back(p.omega * (1 + sign * k * width));
  }
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

/// The transfers; empty matrices where a frequency is a pole.
struct Sweep {
  std::vector<double> omega, hertz;
  std::vector<MatrixXcd> G;
};

MatrixXcd transfer_or_none(const System& system, double omega) {
  try {
    return system.transfer({0, omega});
  } catch (const Error& error) {
    if (!error.has(Code::singular)) throw;
    return {};
  }
}

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

std::vector<double> magnitude(const Sweep& w, const Pair& p) {
  std::vector<double> y;
  for (const MatrixXcd& G : w.G) y.push_back(G.size() ? std::abs(G(p.output, p.input)) : kNone);
  return y;
}

/// In degrees, without jumps; where it turns by 180 at once, towards -90.
std::vector<double> phase(const Sweep& w, const Pair& p) {
  std::vector<double> y;
  double last = -90;
  for (const MatrixXcd& G : w.G) {
    if (G.size() == 0 || std::abs(G(p.output, p.input)) == 0) {
      y.push_back(kNone);
      continue;
    }
    double now = std::arg(G(p.output, p.input)) * 180 / std::numbers::pi;
    now += 360 * std::round((last - now) / 360);
    if (std::abs(now - last) > 179) {
      const double other = now > last ? now - 360 : now + 360;
      if (std::abs(other + 90) < std::abs(now + 90)) now = other;
    }
    y.push_back(last = now);
  }
  return y;
}

// --- which pairs -------------------------------------------------------------------------------

/// Largest magnitudes over the sweep, outputs x inputs.
MatrixXd peaks(const Subject& s, const Sweep& w) {
  MatrixXd peak =
      MatrixXd::Zero(static_cast<Index>(s.outputs.size()), static_cast<Index>(s.inputs.size()));
  for (const MatrixXcd& G : w.G)
    if (G.size()) peak = peak.cwiseMax(G.cwiseAbs());
  return peak;
}

/// Of every pair of groups the entry with the highest peak, where it is not zero to rounding.
std::vector<Pair> strongest(const std::vector<Group>& outputs, const std::vector<Group>& inputs,
                            const MatrixXd& peak) {
  std::vector<Pair> list;
  for (std::size_t a = 0; a < inputs.size(); ++a)
    for (std::size_t b = 0; b < outputs.size(); ++b) {
      Pair best{outputs[b].at.front(), inputs[a].at.front(), static_cast<int>(b),
                static_cast<int>(a)};
      for (const int i : outputs[b].at)
        for (const int j : inputs[a].at)
          if (peak(i, j) > peak(best.output, best.input)) best.output = i, best.input = j;
      const double usual =
          std::sqrt(peak.row(best.output).maxCoeff()) * std::sqrt(peak.col(best.input).maxCoeff());
      if (peak(best.output, best.input) > 1e-12 * usual) list.push_back(best);
    }
  return list;
}

template <class List>
int group_of(const List& groups, int scalar) {
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const int i : groups[g].at)
      if (i == scalar) return static_cast<int>(g);
  return 0;
}

int find(const std::vector<Scalar>& list, const std::string& name, const char* what) {
  std::string known;
  for (const Scalar& s : list) {
    if (s.name == name) return s.index;
    if (s.index < 20) known += (known.empty() ? "" : ", ") + s.name;
  }
  throw Error(Code::unknown_name,
              fmt::format("ReportOptions::pairs: there is no {} \"{}\"", what, name),
              fmt::format("{}s are: {}", what, known));
}

std::vector<Pair> asked(const Subject& s, const std::vector<Group>& outputs,
                        const std::vector<Group>& inputs) {
  std::vector<Pair> list;
  for (const auto& [output, input] : s.options.pairs) {
    Pair p{find(s.outputs, output, "output"), find(s.inputs, input, "input"), 0, 0};
    p.output_group = group_of(outputs, p.output);
    p.input_group = group_of(inputs, p.input);
    list.push_back(p);
  }
  return list;
}

/// Pairs that share a figure: the same group of inputs, outputs of the same unit; as many in each
/// where they need several.
std::vector<std::vector<Pair>> by_figure(const Subject& s, const std::vector<Pair>& pairs) {
  std::vector<std::vector<Pair>> together, figures;
  std::map<std::pair<int, std::string>, std::size_t> found;
  for (const Pair& p : pairs) {
    const auto key = std::pair(p.input_group, s.outputs[at(p.output)].unit);
    const auto [place, is_new] = found.emplace(key, together.size());
    if (is_new) together.emplace_back();
    together[place->second].push_back(p);
  }
  for (const auto& list : together) {
    const std::size_t parts = (list.size() + kCurves - 1) / kCurves;
    for (std::size_t i = 0; i < parts; ++i)
      figures.emplace_back(list.begin() + static_cast<Index>(i * list.size() / parts),
                           list.begin() + static_cast<Index>((i + 1) * list.size() / parts));
  }
  return figures;
}

std::string left_out(std::size_t figures, const char* way_out) {
  if (figures <= kFigures) return {};
  return fmt::format("<p class=\"note\">{} more figures are left out; {}.</p>\n",
                     figures - kFigures, way_out);
}

// --- figures -----------------------------------------------------------------------------------

std::string bode(const Subject& s, const Sweep& w, const std::vector<Pair>& pairs) {
  const Scalar& input = s.inputs[at(pairs.front().input)];
  const Scalar& output = s.outputs[at(pairs.front().output)];
  Plot plot{
      .title = fmt::format("{} [{}] from {} [{}]", pairs.size() == 1 ? output.signal : "outputs",
                           or_users(output.unit), input.signal, or_users(input.unit)),
      .caption = {},
      .x = {.label = "frequency", .unit = "Hz", .log = true},
      .labels = {},
      .x_data = {},
      .frames = {}};
  plot.x.low = w.hertz.front(), plot.x.high = w.hertz.back();
  Frame size{.y = {.label = "magnitude", .unit = ratio(output.unit, input.unit), .log = true},
             .curves = {},
             .height = 190};
  Frame turn{.y = {.label = "phase", .unit = "deg", .degrees = true}, .curves = {}, .height = 110};
  for (const Pair& p : pairs) {
    plot.labels.push_back(
        fmt::format("{} / {}", s.outputs[at(p.output)].name, s.inputs[at(p.input)].name));
    plot.x_data.push_back(w.hertz);
    size.curves.push_back(magnitude(w, p));
    turn.curves.push_back(phase(w, p));
  }
  plot.frames = {std::move(size), std::move(turn)};
  return figure(plot);
}

/// Rows (or columns) of one unit, which may be added as vectors.
struct Alike {
  std::string unit, names;
  std::vector<int> at;
};

std::vector<Alike> alike(const std::vector<Group>& groups) {
  std::vector<Alike> list;
  for (const Group& g : groups) {
    const auto fits = [&](const Alike& a) {
      return a.unit == g.unit && (!g.unit.empty() || a.names == g.signal);
    };
    auto found = std::find_if(list.begin(), list.end(), fits);
    if (found == list.end()) found = list.insert(list.end(), {g.unit, {}, {}});
    if (found->names != g.signal && !found->names.ends_with(", " + g.signal))
      found->names += (found->names.empty() ? "" : ", ") + g.signal;
    found->at.insert(found->at.end(), g.at.begin(), g.at.end());
  }
  return list;
}

std::string shortened(const std::string& names) {
  return names.size() <= 60 ? names : names.substr(0, names.rfind(',', 50)) + ", …";
}

/// Singular values, largest first: the eigenvalues of [0 G; G* 0] in real form, each twice there
/// with either sign; good to rounding of the largest.
VectorXd singular_values_of(const MatrixXcd& G) {
  const Index m = G.rows(), n = G.cols(), k = m + n;
  MatrixXd H = MatrixXd::Zero(2 * k, 2 * k);
  H.block(m, 0, n, m) = H.block(k + m, k, n, m) = G.real().transpose();
  H.block(k, m, m, n) = G.imag();
  H.block(k + m, 0, n, m) = -G.imag().transpose();
  const VectorXd values = eigh(H).lambda;
  VectorXd sigma(std::min(m, n));
  for (Index i = 0; i < sigma.size(); ++i) sigma(i) = std::max(0.0, values(2 * k - 1 - 2 * i));
  return sigma;
}

/// Takes out the last curves that are zero as far as rounding can tell.
void drop_zero(std::vector<std::vector<double>>& curves) {
  const auto peak = [](const std::vector<double>& curve) {
    double largest = 0;
    for (const double v : curve)
      if (std::isfinite(v)) largest = std::max(largest, v);
    return largest;
  };
  const double largest = peak(curves.front());
  while (!curves.empty() && peak(curves.back()) <= 1e-11 * largest) curves.pop_back();
}

/// Empty where all are zero.
std::string singular_values(const Sweep& w, const Alike& outputs, const Alike& inputs) {
  const std::size_t count = std::min({outputs.at.size(), inputs.at.size(), kStyles});
  std::vector<std::vector<double>> curves(count);
  for (const MatrixXcd& G : w.G) {
    VectorXd sigma = VectorXd::Constant(static_cast<Index>(count), kNone);
    if (G.size()) sigma = singular_values_of(G(outputs.at, inputs.at));
    for (std::size_t k = 0; k < count; ++k) curves[k].push_back(sigma(static_cast<Index>(k)));
  }
  drop_zero(curves);
  if (curves.empty()) return {};
  const std::string caption = curves.size() == count ? "" : "All others are zero to rounding.";
  Plot plot{
      .title = fmt::format("{} [{}] from {} [{}]", shortened(outputs.names), or_users(outputs.unit),
                           shortened(inputs.names), or_users(inputs.unit)),
      .caption = caption,
      .x = {.label = "frequency", .unit = "Hz", .log = true},
      .labels = {},
      .x_data = {curves.size(), w.hertz},
      .frames = {
          {.y = {.label = "singular values", .unit = ratio(outputs.unit, inputs.unit), .log = true},
           .curves = {},
           .height = 200}}};
  plot.x.low = w.hertz.front(), plot.x.high = w.hertz.back();
  for (std::size_t k = 0; k < curves.size(); ++k) plot.labels.push_back(fmt::format("σ{}", k + 1));
  plot.labels.front() += curves.size() > 1 ? " (largest)" : " (largest gain)";
  plot.frames.front().curves = std::move(curves);
  return figure(plot);
}

std::string all_singular_values(const Sweep& w, const std::vector<Group>& outputs,
                                const std::vector<Group>& inputs) {
  std::string figures;
  std::size_t number = 0;
  for (const Alike& in : alike(inputs))
    for (const Alike& out : alike(outputs)) {
      if (in.at.size() * out.at.size() == 1) continue;
      const std::string one = number < kFigures ? singular_values(w, out, in) : "";
      if (!one.empty() || number >= kFigures) ++number;
      figures += one;
    }
  if (figures.empty()) return {};
  const std::string text =
      "<h3>Singular values</h3>\n<p>The gain from a vector of inputs to a vector of outputs lies "
      "between the largest and the smallest; inputs and outputs of one unit are taken "
      "together.</p>\n<div class=\"figures\">\n";
  return text + figures + "</div>\n" + left_out(number, "compile for fewer inputs or outputs");
}

std::string frequency(const Subject& s, const Sweep& w, const std::vector<Pair>& pairs,
                      const std::vector<Group>& outputs, const std::vector<Group>& inputs) {
  std::string text = all_singular_values(w, outputs, inputs) + "<h3>Bode plots</h3>\n";
  const bool on_axis = std::any_of(s.poles.begin(), s.poles.end(), [](const Pole& p) {
    return p.pair && std::abs(p.damping) < 1e-6;
  });
  text += s.options.pairs.empty() ? "<p>Of every pair of vectors the entry with the highest peak."
                                  : "<p>The pairs that were asked for.";
  text += on_axis
              ? " Undamped modes have peaks without a height: they end where the grid does.</p>\n"
              : "</p>\n";
  const auto figures = by_figure(s, pairs);
  text += "<div class=\"figures\">\n";
  for (std::size_t i = 0; i < figures.size() && i < kFigures; ++i) text += bode(s, w, figures[i]);
  return text + "</div>\n" + left_out(figures.size(), "ask for pairs by ReportOptions::pairs");
}

// --- time --------------------------------------------------------------------------------------

/// The next 1, 2 or 5 times a power of ten.
double round_up(double t) {
  const double unit = std::pow(10.0, std::floor(std::log10(t)));
  for (const double k : {1.0, 2.0, 5.0})
    if (t <= k * unit * (1 + 1e-12)) return k * unit;
  return 10 * unit;
}

struct Clock {
  double until = 1;
  int steps = 500;
  bool coarse = false;  ///< the fastest modes turn between steps
};

/// Eight periods of the slowest oscillation, six time constants of the slowest decay, no more than
/// eight of what grows.
Clock clock(const Subject& s) {
  Clock c;
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

/// Responses to a unit step on one input; what is needed of them.
struct Steps {
  std::vector<double> time;
  std::map<int, MatrixXd> of;  ///< per input: outputs x times
  Stepper stepper = Stepper::exact;
};

Steps steps(const Subject& s, const std::vector<Pair>& pairs, const Clock& c) {
  Steps result;
  for (const Pair& p : pairs) {
    if (result.of.count(p.input)) continue;
    VectorXd u = VectorXd::Zero(static_cast<Index>(s.inputs.size()));
    u(p.input) = 1;
    const Trajectory t =
        simulate(s.system, Excitation::step(u), {.step = c.until / c.steps, .until = c.until});
    result.time = t.time;
    result.stepper = t.stepper;
    result.of[p.input] = t.y;
  }
  return result;
}

/// Where the start goes so far out that nothing else would be seen, the frame shows the rest, and
/// the caption says how far.
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

std::string step_figure(const Subject& s, const Steps& all, const std::vector<Pair>& pairs) {
  const Scalar& input = s.inputs[at(pairs.front().input)];
  const Scalar& output = s.outputs[at(pairs.front().output)];
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
  for (const Pair& p : pairs) {
    const auto row = all.of.at(p.input).row(p.output);
    plot.labels.push_back(
        fmt::format("{}, step on {}", s.outputs[at(p.output)].name, s.inputs[at(p.input)].name));
    plot.x_data.push_back(all.time);
    plot.frames.front().curves.emplace_back(row.begin(), row.end());
  }
  cut_start(plot);
  return figure(plot);
}

std::string time(const Subject& s, const std::vector<Pair>& pairs) {
  auto figures = by_figure(s, pairs);
  const std::size_t count = figures.size();
  figures.resize(std::min(count, kFigures));
  std::vector<Pair> shown;
  for (const auto& f : figures) shown.insert(shown.end(), f.begin(), f.end());
  const Clock c = clock(s);
  const Steps all = steps(s, shown, c);
  std::string text = fmt::format(
      "<p>All states at rest, then a unit step at time 0. {} steps of {:.4g} s, {}{}</p>\n"
      "<div class=\"figures\">\n",
      c.steps, c.until / c.steps,
      all.stepper == Stepper::exact ? "by the matrix exponential: exact at every step."
                                    : "by the implicit midpoint rule through the factors.",
      c.coarse ? " The fastest modes turn more than once in twelve steps: the plots show their "
                 "range, not every swing."
               : "");
  for (const auto& f : figures) text += step_figure(s, all, f);
  return text + "</div>\n" + left_out(count, "ask for pairs by ReportOptions::pairs");
}

}  // namespace

Responses responses(const Subject& s) {
  if (s.inputs.empty() || s.outputs.empty()) {
    const std::string none =
        fmt::format("<p>The scene has no {}: there is no response to show.</p>\n",
                    s.inputs.empty() ? "inputs" : "outputs");
    return {{}, none, none};
  }
  const std::vector<Group> outputs = groups(s.outputs), inputs = groups(s.inputs);
  const Sweep w = sweep(s);
  Responses r;
  r.pairs =
      s.options.pairs.empty() ? strongest(outputs, inputs, peaks(s, w)) : asked(s, outputs, inputs);
  if (r.pairs.empty()) {
    r.frequency = r.time = "<p>No input reaches any output: all responses are 0.</p>\n";
    return r;
  }
  r.frequency = frequency(s, w, r.pairs, outputs, inputs);
  r.time = time(s, r.pairs);
  return r;
}

}  // namespace titop::report
