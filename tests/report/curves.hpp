#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "markup.hpp"

/// Reads the curves of our plots as a reader does: by the numbers at the axes' ticks.
namespace titop_test {

using Points = std::vector<std::pair<double, double>>;

/// The inside of each frame.
inline std::vector<std::string> frames_of(const std::string& svg) {
  return between(svg, "<svg x=", "</svg>");
}

/// Points of a curve in a frame, in pixels from its upper left corner.
inline Points curve_of(const std::string& frame, const std::string& style = "c1") {
  Points list;
  for (std::string text : between(frame, "<path class=\"curve " + style + "\" d=\"", "\"")) {
    for (char& c : text)
      if (c == 'M' || c == 'L') c = ' ';
    const char* at = text.c_str();
    for (char* end = nullptr;; at = end) {
      const double x = std::strtod(at, &end);
      if (end == at) break;
      const double y = std::strtod(end, &end);
      list.emplace_back(x, y);
    }
  }
  return list;
}

inline double attribute(const std::string& tag, const std::string& name) {
  const auto found = between(" " + tag, " " + name + "=\"", "\"");
  REQUIRE(!found.empty());
  return std::stod(found.front());
}

/// An axis by the numbers at its first and last tick, as a reader sees it.
struct SeenAxis {
  bool log;
  std::pair<double, double> first, last;  ///< place [px], number

  SeenAxis(const std::string& part, const char* anchor, const char* along, bool is_log,
           double origin)
      : log(is_log) {
    Points ticks;
    for (const std::string& tick : between(part, "<text class=\"tick\" ", "</text>"))
      if (has(tick, std::string("text-anchor=\"") + anchor))
        ticks.emplace_back(attribute(tick, along) - origin,
                           std::stod(tick.substr(tick.find('>') + 1)));
    REQUIRE(ticks.size() >= 2);
    first = ticks.front(), last = ticks.back();
  }
  double scaled(double v) const { return log ? std::log10(v) : v; }
  double place(double v) const {
    return first.first + (last.first - first.first) * (scaled(v) - scaled(first.second)) /
                             (scaled(last.second) - scaled(first.second));
  }
  double value(double px) const {
    const double v = scaled(first.second) + (px - first.first) / (last.first - first.first) *
                                                (scaled(last.second) - scaled(first.second));
    return log ? std::pow(10, v) : v;
  }
};

/// Rounding of points and ticks to 0.1 px, by 0.05 px each, and a fifth for places beyond the
/// ticks.
constexpr double kRounded = 0.12;

/// Largest distance in height [px], over 1 + steepness, between the points of a curve and y(x), x
/// and y read at the axes' ticks.
inline double distance(const std::string& svg, std::size_t frame, const std::string& style,
                       bool log_x, bool log_y, const std::function<double(double)>& y) {
  const std::string open = "<svg x=";
  std::vector<std::string> parts;  // a frame and what follows up to the next one
  for (std::size_t at = svg.find(open); at != std::string::npos;) {
    const std::size_t next = svg.find(open, at + open.size());
    parts.push_back(svg.substr(at + 5, next == std::string::npos ? next : next - at - 5));
    at = next;
  }
  const std::string& part = parts.at(frame);
  const SeenAxis across(parts.back(), "middle", "x", log_x, attribute(part, "x"));
  const SeenAxis up(part, "end", "y", log_y, attribute(part, "y") + 4);  // a number's foot
  const Points curve = curve_of(frames_of(svg).at(frame), style);
  REQUIRE(curve.size() >= 100);
  CHECK(std::abs(curve.front().first) <= 0.01);  // written in hundredths
  CHECK(std::abs(curve.back().first - 440) <= 0.01);
  double largest = 0;
  for (const auto& [px, py] : curve) {
    const auto at = [&](double x) { return up.place(y(across.value(x))); };
    const double steepness = std::abs(at(px + 0.5) - at(px - 0.5));
    largest = std::max(largest, std::abs(at(px) - py) / (1 + steepness));
  }
  return largest;
}

}  // namespace titop_test
