#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/analysis/control/margins.hpp>
#include <titop/analysis/control/zeros.hpp>
#include <titop/emit/report/figures.hpp>
#include <titop/emit/report/plots.hpp>
#include <titop/emit/text/write_file.hpp>

namespace titop {
namespace {

using report::Plot;
using report::PointStyle;
using Complex = std::complex<double>;

ReportOptions as_report(const PlotOptions& options,
                        std::vector<std::pair<std::string, std::string>> pairs = {}) {
  ReportOptions r;
  r.pairs = std::move(pairs);
  r.band_hz = options.band_hz;
  r.until = options.until;
  return r;
}

std::string finished(Plot plot, const PlotOptions& options) {
  if (!options.title.empty()) plot.title = options.title;
  return report::standalone(plot);
}

/// Frequencies of the band [rad/s].
std::vector<double> frequencies(const System& system, const PlotOptions& options) {
  const ReportOptions r = as_report(options);
  return report::sweep_frequencies(report::subject(system, r));
}

/// That of ReportOptions::pairs. Throws unknown_name.
std::vector<report::IoPair> the_pair(const report::Subject& s) {
  return report::asked(s, report::groups(s.outputs), report::groups(s.inputs));
}

struct Curve {
  std::vector<double> x, y;
};

void add(Plot& plot, const std::string& label, Curve curve, PointStyle mark) {
  plot.labels.push_back(label);
  plot.x_data.push_back(std::move(curve.x));
  plot.frames.front().curves.push_back(std::move(curve.y));
  plot.frames.front().marks.push_back(mark);
}

Curve poles_of(const std::vector<Pole>& poles, double highest) {
  Curve c;
  for (const Pole& p : poles) {
    if (p.omega > highest) continue;
    c.x.push_back(p.s.real()), c.y.push_back(p.s.imag());
    if (p.pair) c.x.push_back(p.s.real()), c.y.push_back(-p.s.imag());
  }
  return c;
}

Curve zeros_of(const StateSpace& model, double highest) {
  Curve c;
  for (const Complex& s : transmission_zeros(model))
    if (std::abs(s) <= highest) c.x.push_back(s.real()), c.y.push_back(s.imag());
  return c;
}

}  // namespace

std::string plot_bode(const System& system, const std::string& output, const std::string& input,
                      const PlotOptions& options) {
  const ReportOptions r = as_report(options, {{output, input}});
  const report::Subject s = report::subject(system, r);
  return finished(report::bode_plot(s, report::sweep(s), the_pair(s)), options);
}

std::string plot_step(const System& system, const std::string& output, const std::string& input,
                      const PlotOptions& options) {
  const ReportOptions r = as_report(options, {{output, input}});
  const report::Subject s = report::subject(system, r);
  return finished(report::step_plot(s, the_pair(s)), options);
}

std::string plot_sigma(const System& system, const PlotOptions& options) {
  const ReportOptions r = as_report(options);
  const report::Subject s = report::subject(system, r);
  const auto plot =
      report::sigma_plot(report::sweep(s), report::groups(s.outputs), report::groups(s.inputs));
  if (!plot)
    throw Error(Code::bad_value, "all singular values are 0", "no input reaches any output");
  return finished(*plot, options);
}

std::string plot_nyquist(const ControlLoop& loop, const PlotOptions& options) {
  return finished(report::nyquist_plot(loop, margins(loop), frequencies(loop.L, options)), options);
}

std::string plot_poles(const System& system, const PlotOptions& options) {
  const double highest = options.band_hz[1] > 0 ? report::kTwoPi * options.band_hz[1] : HUGE_VAL;
  Plot plot{
      .title = "poles and transmission zeros",
      .caption = {},
      .x = {.label = "real part", .unit = "rad/s"},
      .labels = {},
      .x_data = {},
      .frames = {{.y = {.label = "imaginary part", .unit = "rad/s"}, .curves = {}, .height = 360}}};
  add(plot, "poles", poles_of(system.poles(), highest), PointStyle::cross);
  add(plot, "zeros", zeros_of(system.state_space(), highest), PointStyle::circle);
  return finished(std::move(plot), options);
}

std::string plot_mode(const System& system, int pole, const ModePlotOptions& options) {
  const int wanted[] = {pole};
  return report::standalone(report::mode_plot(mode_shapes(system, wanted), 0, options));
}

void write_plot(const std::string& svg, const std::filesystem::path& file) {
  emit::write_file(file, svg);
}

}  // namespace titop
