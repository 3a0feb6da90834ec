#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/analysis/control/response.hpp>
#include <titop/emit/report/figures.hpp>
#include <titop/emit/report/plot.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::report {
namespace {

using Eigen::MatrixXcd;
using linalg::at;

std::vector<double> magnitude(const Sweep& w, const IoPair& p) {
  std::vector<double> y;
  for (const MatrixXcd& G : w.G) y.push_back(G.size() ? std::abs(G(p.output, p.input)) : kNone);
  return y;
}

std::vector<double> phase(const Sweep& w, const IoPair& p) {
  std::vector<std::complex<double>> values;
  for (const MatrixXcd& G : w.G) values.push_back(G.size() ? G(p.output, p.input) : 0.0);
  return degrees(values);
}

}  // namespace

Plot bode_plot(const Subject& s, const Sweep& w, const std::vector<IoPair>& pairs) {
  const ScalarSignal& input = s.inputs[at(pairs.front().input)];
  const ScalarSignal& output = s.outputs[at(pairs.front().output)];
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
  for (const IoPair& p : pairs) {
    plot.labels.push_back(
        fmt::format("{} / {}", s.outputs[at(p.output)].name, s.inputs[at(p.input)].name));
    plot.x_data.push_back(w.hertz);
    size.curves.push_back(magnitude(w, p));
    turn.curves.push_back(phase(w, p));
  }
  plot.frames = {std::move(size), std::move(turn)};
  return plot;
}

std::string bode_plots(const Subject& s, const Sweep& w, const std::vector<IoPair>& pairs) {
  std::string text = "<h3>Bode plots</h3>\n";
  const bool on_axis = std::any_of(s.poles.begin(), s.poles.end(), [](const Pole& p) {
    return p.pair && std::abs(p.damping) < linalg::kPoleOnAxis;
  });
  text += s.options.pairs.empty() ? "<p>Of every pair of vectors the entry with the highest peak."
                                  : "<p>The requested pairs.";
  text += on_axis
              ? " Undamped modes have peaks without a height: they end where the grid does.</p>\n"
              : "</p>\n";
  const auto figures = by_figure(s, pairs);
  text += "<div class=\"figures\">\n";
  for (std::size_t i = 0; i < figures.size() && i < kFigures; ++i)
    text += figure(bode_plot(s, w, figures[i]));
  return text + "</div>\n" + left_out(figures.size(), "ask for pairs by ReportOptions::pairs");
}

}  // namespace titop::report
