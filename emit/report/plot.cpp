#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/diagram/text.hpp>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/plot.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::report {
namespace {

constexpr double kWidth = 520, kLeft = 66, kRight = 14, kTop = 8, kGap = 12, kBottom = 40,
                 kInner = kWidth - kLeft - kRight;  // [px]
/// Relative: a smaller difference of values does not show in a curve.
constexpr double kLastDigits = 1e-12;
/// Of a step between ticks, or of a decade: rounding of a limit that is a tick.
constexpr double kOnTick = 1e-9;
static_assert(kInner == kPlotWidth);

struct Tick {
  double value = 0;
  std::string text;
};

/// An axis with its range, and how a value becomes a place on it.
class Scale {
 public:
  Scale(const PlotAxis& axis, double low, double high) : axis_(axis), low_(low), high_(high) {
    if (axis.log)
      log_range();
    else
      linear_range();
    if (axis.hidden) ticks_.clear(), fine_.clear();
  }

  /// 0 at the low end, 1 at the high one; clamped to [-0.5, 1.5].
  double place(double v) const {
    if (axis_.log) v = v > 0 ? std::log10(v) : -HUGE_VAL;
    return std::clamp((v - low_) / (high_ - low_), -0.5, 1.5);
  }

  std::string title() const {
    const std::string factor = exponent_ ? power_of_ten(exponent_) : "";
    if (factor.empty() && axis_.unit.empty()) return axis_.label;
    const std::string space = factor.empty() || axis_.unit.empty() ? "" : " ";
    return fmt::format("{} [{}{}{}]", axis_.label, factor, space, axis_.unit);
  }

  const std::vector<Tick>& ticks() const { return ticks_; }
  const std::vector<double>& fine() const { return fine_; }  ///< between decades

 private:
  void linear_range() {
    if (!std::isfinite(low_) || !std::isfinite(high_)) low_ = 0, high_ = 1;  // nothing to show
    // A curve that varies only in its last digits is a constant.
    if (!(high_ - low_ > kLastDigits * std::max(std::abs(low_), std::abs(high_)))) {
      const double pad = low_ == 0 ? 1 : 0.5 * std::abs(low_);
      low_ -= pad, high_ += pad;
    }
    const double size = std::max(std::abs(low_), std::abs(high_));
    if (!axis_.degrees && (size >= 1e5 || size < 1e-2))
      exponent_ = 3 * static_cast<int>(std::floor(std::log10(size) / 3));
    const double unit = std::pow(10.0, exponent_);
    const Ticks t = linear_ticks(low_ / unit, high_ / unit, axis_.degrees);
    for (const double v : t.at) {
      const double clean = std::abs(v) < kOnTick * t.step ? 0 : v;
      ticks_.push_back({clean * unit, fmt::format("{:.6g}", clean)});
    }
  }

  void log_range() {
    low_ = std::log10(low_), high_ = std::log10(high_);
    if (!std::isfinite(low_) || !std::isfinite(high_)) low_ = 0, high_ = 1;  // nothing to show
    if (high_ - low_ < 0.5) {
      const double middle = (low_ + high_) / 2;
      low_ = middle - 0.25, high_ = middle + 0.25;
    }
    const int first = static_cast<int>(std::ceil(low_ - kOnTick)),
              last = static_cast<int>(std::floor(high_ + kOnTick));
    const bool plain = low_ >= -3.01 && high_ <= 5.01, few = high_ - low_ < 2;
    const int stride = std::max(1, (last - first + 6) / 7);
    for (int decade = first - 1; decade <= last; ++decade)
      for (int k = 1; k < 10; ++k) {
        const double v = k * std::pow(10.0, decade), at = std::log10(v);
        if (at < low_ - kOnTick || at > high_ + kOnTick) continue;
        const bool named = k == 1 ? (decade - first) % stride == 0 : few && (k == 2 || k == 5);
        if (named)
          ticks_.push_back({v, plain || k > 1 ? fmt::format("{:.6g}", v) : power_of_ten(decade)});
        else if (stride == 1 || k == 1)
          fine_.push_back(v);
      }
  }

  const PlotAxis& axis_;
  double low_, high_;  ///< of the exponent if the axis is logarithmic
  int exponent_ = 0;
  std::vector<Tick> ticks_;
  std::vector<double> fine_;
};

/// Smallest and largest value that can be drawn, within twelve decades of the largest on a log
/// axis.
Scale scale_of(const PlotAxis& axis, const std::vector<std::vector<double>>& data) {
  if (axis.low != axis.high) return {axis, axis.low, axis.high};
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const auto& curve : data)
    for (const double v : curve)
      if (std::isfinite(v) && (v > 0 || !axis.log))
        low = std::min(low, v), high = std::max(high, v);
  if (!(low <= high)) return {axis, axis.log ? 0.1 : 0, 1};
  if (axis.log) {
    low = std::max(low, high * kLastDigits);
    const double pad = std::pow(high / low, 0.04);
    return {axis, low / pad, high * pad};
  }
  const double pad = 0.05 * (high - low);
  return {axis, low - pad, high + pad};
}

/// The points of a column of pixels that show all of it: first, lowest, highest, last.
class Path {
 public:
  void add(double x, double y) {
    const double column = std::floor(2 * x);
    if (points_.empty() || column != column_) flush(), column_ = column;
    points_.emplace_back(x, y);
  }
  void gap() {
    flush();
    pen_down_ = false;
  }
  std::string text() {
    flush();
    return text_;
  }

 private:
  void flush() {
    if (points_.empty()) return;
    const auto by_y = [](const auto& a, const auto& b) { return a.second < b.second; };
    const auto [lowest, highest] = std::minmax_element(points_.begin(), points_.end(), by_y);
    std::vector<std::size_t> keep = {0, static_cast<std::size_t>(lowest - points_.begin()),
                                     static_cast<std::size_t>(highest - points_.begin()),
                                     points_.size() - 1};
    detail::keep_each_once(keep);
    for (const std::size_t i : keep) {
      text_ += fmt::format("{}{:.1f} {:.1f}", pen_down_ ? "L" : "M", points_[i].first,
                           points_[i].second);
      pen_down_ = true;
    }
    points_.clear();
  }

  std::string text_;
  bool pen_down_ = false;
  double column_ = 0;
  std::vector<std::pair<double, double>> points_;
};

std::string style(std::size_t curve) { return fmt::format("curve c{}", curve % kStyles + 1); }

std::string curve_path(const std::vector<double>& x, const std::vector<double>& y,
                       const Scale& across, const Scale& up, int height) {
  Path path;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(y[i])) {
      path.gap();
      continue;
    }
    path.add(kInner * across.place(x[i]), height * (1 - up.place(y[i])));
  }
  return path.text();
}

PointStyle mark_of(const Frame& frame, std::size_t curve) {
  return curve < frame.marks.size() ? frame.marks[curve] : PointStyle::line;
}

/// A cross or a circle of 8 pixels.
std::string mark_at(double x, double y, PointStyle mark) {
  return mark == PointStyle::cross
             ? fmt::format("M{:.1f} {:.1f}l8 8m0 -8l-8 8", x - 4, y - 4)
             : fmt::format("M{:.1f} {:.1f}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0", x - 4, y);
}

/// Points one by one, those outside of the frame left out.
std::string marks_path(const std::vector<double>& x, const std::vector<double>& y,
                       const Scale& across, const Scale& up, int height, PointStyle mark) {
  std::string text;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = across.place(x[i]), b = up.place(y[i]);
    if (!(a >= 0 && a <= 1 && b >= 0 && b <= 1)) continue;
    text += mark_at(kInner * a, height * (1 - b), mark);
  }
  return text;
}

std::string line(const char* cls, double x1, double y1, double x2, double y2) {
  return fmt::format(R"(<path class="{}" d="M{:.1f} {:.1f}L{:.1f} {:.1f}"/>)", cls, x1, y1, x2, y2);
}

std::string grid(const Scale& across, const Scale& up, double top, int height) {
  std::string text;
  const auto vertical = [&](const char* cls, double v) {
    const double x = kLeft + kInner * across.place(v);
    text += line(cls, x, top, x, top + height);
  };
  const auto horizontal = [&](const char* cls, double v) {
    const double y = top + height * (1 - up.place(v));
    text += line(cls, kLeft, y, kLeft + kInner, y);
  };
  for (const double v : across.fine()) vertical("fine", v);
  for (const double v : up.fine()) horizontal("fine", v);
  for (const Tick& t : across.ticks()) vertical("grid", t.value);
  for (const Tick& t : up.ticks()) horizontal(t.value == 0 ? "zero" : "grid", t.value);
  return text;
}

std::ptrdiff_t letters(const std::string& utf8) {
  return std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xC0) != 0x80; });
}

/// Along the frame; a longer text in smaller letters.
std::string y_label(const std::string& title, double middle, int height) {
  constexpr double kSize = 12.5, kLetter = 0.56;  // [px] and mean width over size
  const double fits = (height + kTop + kGap) / (kLetter * static_cast<double>(letters(title)));
  const std::string small =
      fits >= kSize ? "" : fmt::format(R"( style="font-size:{:.1f}px")", std::max(fits, 7.0));
  return fmt::format(
      R"-(<text class="y-label"{2} x="14" y="{0}" text-anchor="middle" transform="rotate(-90 14 {0})">{1}</text>)-",
      middle, diagram::html(title), small);
}

/// Left of the frame; a longer number than fits between the label and the frame is narrowed.
std::string y_tick(const std::string& number, double y) {
  constexpr double kEnd = kLeft - 6, kLabelEnd = 18;  // [px]
  constexpr int kFits = 6;                            // digits of 12 px
  const std::string narrowed =
      letters(number) <= kFits
          ? ""
          : fmt::format(R"( textLength="{}" lengthAdjust="spacingAndGlyphs")", kEnd - kLabelEnd);
  return fmt::format(R"(<text class="tick" x="{}" y="{:.1f}" text-anchor="end"{}>{}</text>)", kEnd,
                     y, narrowed, number);
}

std::string draw(const Plot& plot, const Frame& frame, const Scale& across, double top) {
  const Scale up = scale_of(frame.y, frame.curves);
  std::string text = grid(across, up, top, frame.height);
  text += fmt::format(R"(<svg x="{}" y="{}" width="{}" height="{}">)", kLeft, top, kInner,
                      frame.height);
  for (std::size_t i = 0; i < frame.curves.size(); ++i) {
    const PointStyle mark = mark_of(frame, i);
    const std::string path =
        mark == PointStyle::line
            ? curve_path(plot.x_data[i], frame.curves[i], across, up, frame.height)
            : marks_path(plot.x_data[i], frame.curves[i], across, up, frame.height, mark);
    text += fmt::format(R"(<path class="{}" d="{}"/>)",
                        mark == PointStyle::line ? style(i) : "curve mark", path);
  }
  text += fmt::format(R"(</svg><rect class="frame" x="{}" y="{}" width="{}" height="{}"/>)", kLeft,
                      top, kInner, frame.height);
  for (const Tick& t : up.ticks())
    text += y_tick(t.text, top + frame.height * (1 - up.place(t.value)) + 4);
  const double middle = top + frame.height / 2.0;
  for (const PlotText& t : frame.texts)
    text += fmt::format(
        R"(<text class="tick over" x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)",
        kLeft + kInner * across.place(t.x), top + frame.height * (1 - up.place(t.y)) + 4,
        diagram::html(t.text));
  return frame.y.hidden ? text : text + y_label(up.title(), middle, frame.height);
}

std::string legend(const Plot& plot) {
  std::string text = R"(<ul class="legend">)";
  for (std::size_t i = 0; i < plot.labels.size(); ++i) {
    const PointStyle mark = mark_of(plot.frames.front(), i);
    const bool line = mark == PointStyle::line;
    text += fmt::format(
        R"(<li><svg class="sample" width="36" height="10" viewBox="0 0 36 10" aria-hidden="true"><path class="{}" d="{}"/></svg>{}</li>)",
        line ? style(i) : "curve mark", line ? "M1 5H35" : mark_at(18, 5, mark),
        diagram::html(plot.labels[i]));
  }
  return text + "</ul>";
}

}  // namespace

Ticks linear_ticks(double low, double high, bool degrees) {
  constexpr double kMost = 7;
  const auto number = [&](double step) {
    return std::floor(high / step + kOnTick) - std::ceil(low / step - kOnTick) + 1;
  };
  Ticks t;
  if (degrees && number(45) >= 3) {
    for (t.step = 45; number(t.step) > kMost;) t.step *= 2;
  } else {
    double unit = std::pow(10.0, std::floor(std::log10((high - low) / 10)));
    for (t.step = unit; number(t.step) > kMost; unit *= 10)
      for (const double k : {1.0, 2.0, 2.5, 5.0})
        if (number(t.step) > kMost) t.step = k * unit;
  }
  const double first = std::ceil(low / t.step - kOnTick);
  for (int k = 0, count = static_cast<int>(number(t.step)); k < count; ++k)
    t.at.push_back((first + k) * t.step);
  return t;
}

Drawn drawn(const Plot& plot) {
  const Scale across = scale_of(plot.x, plot.x_data);
  std::string frames;
  double top = kTop;
  for (const Frame& frame : plot.frames) {
    frames += draw(plot, frame, across, top);
    top += frame.height + kGap;
  }
  const double bottom = top - kGap;
  if (plot.x.hidden) return {std::move(frames), kWidth, bottom + kTop};
  for (const Tick& t : across.ticks())
    frames += fmt::format(R"(<text class="tick" x="{:.1f}" y="{}" text-anchor="middle">{}</text>)",
                          kLeft + kInner * across.place(t.value), bottom + 16, t.text);
  frames += fmt::format(R"(<text class="x-label" x="{}" y="{}" text-anchor="middle">{}</text>)",
                        kLeft + kInner / 2, bottom + 34, diagram::html(across.title()));
  return {std::move(frames), kWidth, bottom + kBottom};
}

std::string figure(const Plot& plot) {
  const Drawn d = drawn(plot);
  const std::string name = diagram::html(plot.title);
  return fmt::format(
      R"(<figure class="plot"><h4>{0}</h4>{1}<svg role="img" aria-label="{0}" viewBox="0 0 {2} {3}">{4}</svg>{5}</figure>)"
      "\n",
      name, legend(plot), d.width, d.height, d.svg,
      plot.caption.empty() ? "" : "<figcaption>" + diagram::html(plot.caption) + "</figcaption>");
}

}  // namespace titop::report
