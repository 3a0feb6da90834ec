#include <fmt/format.h>

#include <cmath>
#include <titop/analysis/control/margins.hpp>
#include <titop/emit/report/figures.hpp>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/sweep.hpp>

/// Margins of the diagram's loop points, and their Nyquist curves.
namespace titop::report {
namespace {

using NyquistPoints = std::pair<std::vector<double>, std::vector<double>>;  // real, imaginary parts

/// L of loop i with all others closed; where it is large the curve has gaps.
NyquistPoints nyquist_points(const ControlLoop& loop, Eigen::Index i,
                             const std::vector<double>& omega) {
  constexpr double kLargest = 30;
  NyquistPoints points;
  for (const double w : omega) {
    std::complex<double> value(HUGE_VAL, 0);
    try {
      const Eigen::MatrixXcd S = loop.S.transfer({0, w});
      value = 1.0 / S(i, i) - 1.0;  // 1 / (1 + L_i) is S's own entry
    } catch (const Error& error) {
      if (!error.has(Code::singular)) throw;
    }
    const bool shown = std::abs(value) < kLargest;
    points.first.push_back(shown ? value.real() : kNone);
    points.second.push_back(shown ? value.imag() : kNone);
  }
  return points;
}

NyquistPoints unit_circle() {
  NyquistPoints points;
  for (int k = 0; k <= 180; ++k) {
    points.first.push_back(std::cos(k * kTwoPi / 180));
    points.second.push_back(std::sin(k * kTwoPi / 180));
  }
  return points;
}

void add_points(Plot& plot, const std::string& label, NyquistPoints points, PointStyle mark) {
  plot.labels.push_back(label);
  plot.x_data.push_back(std::move(points.first));
  plot.frames.front().curves.push_back(std::move(points.second));
  plot.frames.front().marks.push_back(mark);
}

std::string nyquist_caption(const Margins& m) {
  if (!m.stable) return "The closed loop is not stable.";
  std::string text;
  for (const LoopMargins& l : m.loops)
    text += fmt::format("{}{}: nearest to -1 at {:.4g} rad/s, distance {:.4g}, disk margin {:.4g}.",
                        text.empty() ? "" : " ", l.point, l.nearest.omega, l.nearest.value,
                        l.disk.alpha);
  return text;
}

std::string where(const MarginAt& m) {
  return std::isinf(m.omega) ? "at high frequencies"
                             : fmt::format("at {} Hz", number(m.omega / kTwoPi));
}

std::string gain_cell(const MarginAt& m) {
  if (m.value == 0 || std::isinf(m.value)) return "none";
  return fmt::format("{:+.2f} dB {}", decibels(m.value), where(m));
}

std::string phase_cell(const MarginAt& m) {
  return std::isinf(m.value) ? "none" : fmt::format("{:.1f}° {}", degrees(m.value), where(m));
}

std::string delay_cell(const MarginAt& m) {
  return std::isinf(m.value) ? "none" : fmt::format("{} s {}", number(m.value), where(m));
}

std::string margin_row(const LoopMargins& m) {
  return row(
      {escaped(m.point), gain_cell(m.larger_gain), gain_cell(m.smaller_gain), phase_cell(m.phase),
       delay_cell(m.delay), fmt::format("{} {}", number(m.nearest.value), where(m.nearest)),
       number(m.disk.alpha)},
      {"name", "", "", "", "", "", "n"});
}

/// The largest distance of several loops at once.
std::string of_all_loops(const Margins& m) {
  if (m.loops.size() < 2) return {};
  return fmt::format(
      "<p>All loops at once, each with a gain and phase of its own: disk margin {} (gains from {} "
      "to {}, phases up to {:.1f}°), a lower bound that depends on the units of the signals.</p>\n",
      number(m.disk.alpha), number(m.disk.least_gain()), number(m.disk.largest_gain()),
      degrees(m.disk.phase()));
}

std::string unstable(const Margins& m) {
  return fmt::format(
      "<ul class=\"verdicts\">\n<li class=\"bad\">The closed loop is not stable: {} right of the "
      "axis, {} on it up to rounding.</li>\n</ul>\n",
      count(static_cast<std::size_t>(m.nyquist.closed_right), "pole"), m.nyquist.closed_on_axis);
}

std::string table_of(const Margins& m) {
  const std::vector<std::string> classes = {"", "", "", "", "", "", "n"};
  std::string text =
      "<div class=\"table\"><table>\n" +
      row({"loop", "larger gain", "smaller gain", "phase", "delay", "nearest to −1", "disk margin"},
          classes, "th");
  for (const LoopMargins& l : m.loops) text += margin_row(l);
  return text + "</table></div>\n" + of_all_loops(m);
}

/// By the poles of the loop: the report's band may leave out the crossings.
std::vector<double> frequencies_of_loop(const ControlLoop& cut) {
  const ReportOptions plain;
  return sweep_frequencies(subject(cut.L, plain));
}

std::string warnings_of_loop(const Margins& m) {
  if (m.warnings.empty()) return {};
  std::string text = "<ul class=\"verdicts\">\n";
  for (const std::string& w : m.warnings)
    text += fmt::format("<li class=\"open\">L, warning of {}</li>\n", escaped(w));
  return text + "</ul>\n";
}

std::string section_of(const Subject& s, const std::string& point) {
  const std::string head = fmt::format("<h3>Loop point {}</h3>\n", escaped(point));
  try {
    const ControlLoop cut = loop(s.system, point);
    const Margins m = margins(cut);
    return head + (m.stable ? table_of(m) : unstable(m)) + warnings_of_loop(m) +
           "<div class=\"figures\">\n" + figure(nyquist_plot(cut, m, frequencies_of_loop(cut))) +
           "</div>\n";
  } catch (const Error& error) {
    return head +
           fmt::format("<p class=\"note\">No margins: {}</p>\n", escaped_lines(error.what()));
  }
}

}  // namespace

Plot nyquist_plot(const ControlLoop& loop, const Margins& m, const std::vector<double>& omega) {
  Plot plot{.title = "Nyquist curve",
            .caption = nyquist_caption(m),
            .x = {.label = "real part", .unit = "", .low = -3, .high = 3},
            .labels = {},
            .x_data = {},
            .frames = {{.y = {.label = "imaginary part", .unit = "", .low = -3, .high = 3},
                        .curves = {},
                        .height = 440}}};
  for (std::size_t i = 0; i < m.loops.size(); ++i)
    add_points(plot, m.loops[i].point, nyquist_points(loop, static_cast<Eigen::Index>(i), omega),
               PointStyle::line);
  add_points(plot, "unit circle", unit_circle(), PointStyle::line);
  add_points(plot, "-1", {{-1}, {0}}, PointStyle::cross);
  return plot;
}

std::string margins_section(const Subject& s) {
  std::string text;
  const std::vector<std::string> points = loop_points(s.system);
  if (!points.empty() && s.system.order() > s.options.full_up_to)
    return fmt::format(
        "<p class=\"note\">Not computed: {} states are more than {} "
        "(ReportOptions::full_up_to). <code>titop margins</code> has no limit.</p>\n",
        s.system.order(), s.options.full_up_to);
  for (const std::string& point : points) text += section_of(s, point);
  if (text.empty()) return text;
  return "<p>Of each loop alone, the others closed: the gains and the phase that bring the loop "
         "transfer L to −1, the least additional delay, the nearest point of L(jω) to −1, and "
         "α = 2/‖S − T‖: gains and phases in that disk leave the loop stable.</p>\n" +
         text;
}

}  // namespace titop::report
