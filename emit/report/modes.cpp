#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <titop/emit/report/figures.hpp>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/subject.hpp>

/// Mode shapes: the structure's points at rest and displaced, seen from one direction.
namespace titop::report {
namespace {

using Eigen::Index;
using Eigen::Matrix2Xd;
using Eigen::Vector2d;

constexpr double kRadian = kTwoPi / 360;

/// Directions to the right and up of the picture, for a viewer in this direction; z is up.
Eigen::Matrix<double, 2, 3> view_of(const ModePlotOptions& o) {
  const double a = o.azimuth * kRadian, e = o.elevation * kRadian;
  Eigen::Matrix<double, 2, 3> view;
  view << -std::sin(a), std::cos(a), 0, -std::sin(e) * std::cos(a), -std::sin(e) * std::sin(a),
      std::cos(e);
  return view;
}

/// The structure in one mode: places, and displacements as drawn.
struct DrawnMode {
  const ModeShapes& shapes;
  const ModeShape& mode;
  double size = 1;   ///< of the structure [m]
  double scale = 0;  ///< of the displacements

  Vector3d place(int point) const { return shapes.points[static_cast<std::size_t>(point)].place; }
  Vector3d moved(int point) const { return scale * mode.translation.col(point).real(); }
  Vector3d turned(int point) const { return scale * mode.rotation.col(point).real(); }
};

double size_of(const std::vector<StructurePoint>& points) {
  Vector3d low = points.front().place, high = low;
  for (const StructurePoint& p : points) low = low.cwiseMin(p.place), high = high.cwiseMax(p.place);
  const double size = (high - low).norm();
  return size > 0 ? size : 1;  // all in one place
}

/// Displacement on the line from a to b, at 0 <= t <= 1: along the line linear, across it the cubic
/// with the displacements and slopes of both ends, as of a beam.
Vector3d between(const DrawnMode& d, int a, int b, double t) {
  const Vector3d line = d.place(b) - d.place(a), along = line.normalized();
  const auto across = [&](const Vector3d& v) -> Vector3d { return v - along * along.dot(v); };
  const Vector3d ua = d.moved(a), ub = d.moved(b);
  const double h = t * t * (3 - 2 * t);
  return along * along.dot(ua + t * (ub - ua)) + across(ua + h * (ub - ua)) +
         t * (1 - t) * ((1 - t) * d.turned(a).cross(line) - t * d.turned(b).cross(line));
}

struct PointList {
  std::vector<double> x, y;
  void add(const Vector2d& p) { x.push_back(p.x()), y.push_back(p.y()); }
  void gap() { x.push_back(kNone), y.push_back(kNone); }
};

void add(Plot& plot, const char* label, PointList points, PointStyle mark) {
  plot.labels.emplace_back(label);
  plot.x_data.push_back(std::move(points.x));
  plot.frames.front().curves.push_back(std::move(points.y));
  plot.frames.front().marks.push_back(mark);
}

PointList lines_of(const DrawnMode& d, const Eigen::Matrix<double, 2, 3>& view, bool displaced) {
  constexpr int kPieces = 16;
  PointList list;
  for (const auto& [a, b] : d.shapes.lines) {
    if (d.place(a) == d.place(b)) continue;
    for (int i = 0; i <= kPieces; ++i) {
      const double t = double(i) / kPieces;
      Vector3d p = d.place(a) + t * (d.place(b) - d.place(a));
      if (displaced) p += between(d, a, b, t);
      list.add(view * p);
    }
    list.gap();
  }
  return list;
}

PointList points_of(const DrawnMode& d, const Eigen::Matrix<double, 2, 3>& view) {
  PointList list;
  for (int i = 0; i < static_cast<int>(d.shapes.points.size()); ++i)
    list.add(view * (d.place(i) + d.moved(i)));
  return list;
}

/// The axes x, y and z of the first body, at the left end of the picture.
PointList axes_of(Plot& plot, const Eigen::Matrix<double, 2, 3>& view, double size) {
  PointList list;
  const auto least = [](const std::vector<double>& v) {
    double low = HUGE_VAL;
    for (const double x : v) low = std::isfinite(x) ? std::min(low, x) : low;
    return low;
  };
  double left = HUGE_VAL, bottom = HUGE_VAL;
  for (std::size_t i = 0; i < plot.x_data.size(); ++i) {
    left = std::min(left, least(plot.x_data[i]));
    bottom = std::min(bottom, least(plot.frames.front().curves[i]));
  }
  const Vector2d origin(left - 0.15 * size, bottom);
  for (int i = 0; i < 3; ++i) {
    const Vector2d tip = origin + 0.1 * size * view.col(i);
    list.add(origin), list.add(tip), list.gap();
    const Vector2d at = origin + 0.125 * size * view.col(i);
    plot.frames.front().texts.push_back({at.x(), at.y(), std::string(1, "xyz"[i])});
  }
  return list;
}

/// The names of up to 12 bodies, in the middle of their first line.
void add_names(Plot& plot, const DrawnMode& d, const Eigen::Matrix<double, 2, 3>& view) {
  constexpr std::size_t kMost = 12;
  std::vector<PlotText> texts;
  std::set<int> parents;
  for (const auto& [a, b] : d.shapes.lines) {
    if (d.place(a) == d.place(b) || !parents.insert(a).second) continue;
    const Vector2d middle = view * (d.place(a) + d.place(b)) / 2;
    const std::string& point = d.shapes.points[static_cast<std::size_t>(a)].name;
    texts.push_back({middle.x(), middle.y(), point.substr(0, point.rfind('.'))});
  }
  if (texts.size() <= kMost)
    plot.frames.front().texts.insert(plot.frames.front().texts.end(), texts.begin(), texts.end());
}

/// Ranges of both axes in one scale, with a margin; and the frame's height.
void set_ranges(Plot& plot) {
  constexpr double kMargin = 0.08;
  constexpr double kLeastHeight = 140, kMostHeight = 380;  // [px]
  const auto range = [](const std::vector<std::vector<double>>& lists) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const auto& list : lists)
      for (const double v : list)
        if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    return std::pair{(low + high) / 2, (high - low) * (1 + 2 * kMargin)};
  };
  Frame& frame = plot.frames.front();
  auto [x, width] = range(plot.x_data);
  auto [y, depth] = range(frame.curves);
  double height = std::clamp(kPlotWidth * depth / width, kLeastHeight, kMostHeight);
  const double pixel = std::max(width / kPlotWidth, depth / height);
  width = pixel * kPlotWidth, depth = pixel * height;
  plot.x.low = x - width / 2, plot.x.high = x + width / 2;
  frame.y.low = y - depth / 2, frame.y.high = y + depth / 2;
  frame.height = static_cast<int>(height);
}

std::string caption_of(const DrawnMode& d) {
  Index largest = 0;
  d.mode.translation.colwise().norm().maxCoeff(&largest);
  std::string text = fmt::format("{} Hz, damping {} %; {} moves most.", number(d.mode.pole.hertz),
                                 number(100 * d.mode.pole.damping),
                                 d.shapes.points[static_cast<std::size_t>(largest)].name);
  for (const std::string& note : d.shapes.notes) text += " " + note + ".";
  return text;
}

void check_options(const ModePlotOptions& o) {
  if (!std::isfinite(o.azimuth) || !std::isfinite(o.elevation))
    throw Error(Code::bad_value,
                fmt::format("ModePlotOptions: the viewer's direction is {}, {} degrees", o.azimuth,
                            o.elevation),
                "give finite angles");
  if (!(o.amplitude > 0) || !std::isfinite(o.amplitude))
    throw Error(
        Code::bad_value,
        fmt::format("ModePlotOptions::amplitude is {} of the structure's size", o.amplitude),
        "give a positive number, such as 0.15");
}

/// The first conjugate pairs of the model, of those in the report's band.
std::vector<int> shown_modes(const Subject& s) {
  constexpr std::size_t kMost = 6;
  const auto [low, high] = s.options.band_hz;
  std::vector<int> list;
  for (std::size_t i = 0; i < s.poles.size() && list.size() < kMost; ++i) {
    const Pole& p = s.poles[i];
    const bool in_band = high == 0 || (p.hertz >= low && p.hertz <= high);
    if (p.pair && in_band) list.push_back(static_cast<int>(i));
  }
  return list;
}

bool has_points(const System& system) {
  const Graph& g = system.stage().graph;
  return std::any_of(g.channels.begin(), g.channels.end(),
                     [](const Channel& c) { return c.size == 6; });
}

std::string figures_of(const ModeShapes& shapes) {
  std::string text = "<div class=\"figures\">\n";
  for (std::size_t i = 0; i < shapes.modes.size(); ++i) {
    Plot plot = mode_plot(shapes, i, {});
    plot.title = fmt::format("pole {}: {}", shapes.modes[i].index + 1, plot.title);
    text += figure(plot);
  }
  text += "</div>\n";
  for (const std::string& why : shapes.without)
    text += fmt::format("<p class=\"note\">{}</p>\n", escaped(why));
  return text;
}

}  // namespace

Plot mode_plot(const ModeShapes& shapes, std::size_t which, const ModePlotOptions& options) {
  check_options(options);
  const ModeShape& mode = shapes.modes[which];
  DrawnMode d{shapes, mode, size_of(shapes.points), 0};
  d.scale = options.amplitude * d.size;
  const auto view = view_of(options);
  Plot plot{.title = options.title.empty() ? fmt::format("mode of {} Hz", number(mode.pole.hertz))
                                           : options.title,
            .caption = caption_of(d),
            .x = {.label = {}, .unit = {}, .hidden = true},
            .labels = {},
            .x_data = {},
            .frames = {{.y = {.label = {}, .unit = {}, .hidden = true}, .curves = {}}}};
  add(plot, "displaced", lines_of(d, view, true), PointStyle::line);
  add(plot, "at rest", lines_of(d, view, false), PointStyle::line);
  PointList points = points_of(d, view);
  add(plot, "points, displaced", std::move(points), PointStyle::circle);
  PointList axes = axes_of(plot, view, d.size);
  add(plot, "axes", std::move(axes), PointStyle::line);
  add_names(plot, d, view);
  set_ranges(plot);
  return plot;
}

std::string modes_section(const Subject& s) {
  if (!has_points(s.system)) return {};
  constexpr int kCheaper = 4;  // than the margins and the full certificate
  if (s.system.order() > kCheaper * s.options.full_up_to)
    return fmt::format(
        "<p class=\"note\">Not drawn: {} states are more than {} times {} "
        "(ReportOptions::full_up_to). <code>titop draw --mode</code> has no limit.</p>\n",
        s.system.order(), kCheaper, s.options.full_up_to);
  const std::vector<int> modes = shown_modes(s);
  if (modes.empty()) return {};
  std::string drawn;
  try {
    drawn = figures_of(mode_shapes(s.system, modes));
  } catch (const Error& error) {
    return fmt::format("<p class=\"note\">No mode shapes: {}</p>\n", escaped_lines(error.what()));
  }
  return "<p>The slowest modes of the model, as the inputs excite them: the ports of the bodies at "
         "rest and displaced, the largest displacement drawn as 15 % of the structure's size. "
         "Lines "
         "lead from a body's parent port to its children, curved by the turns of both ends.</p>\n" +
         drawn;
}

}  // namespace titop::report
