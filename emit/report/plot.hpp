#pragma once

#include <string>
#include <vector>

/// Line plots as SVG for a page that styles them (page.cpp): colours by class, so that they follow
/// the page's light and dark, dashes and widths, so that they differ in black and white.
namespace titop::report {

struct PlotAxis {
  std::string label;  ///< quantity alone: "frequency"
  std::string unit;   ///< "Hz"; a power of ten is put before it if numbers are small or large
  bool log = false;
  bool degrees = false;      ///< ticks at multiples of 45, 90, 180
  double low = 0, high = 0;  ///< equal: from the data
  bool hidden = false;       ///< without ticks, grid and title
};

/// How the points of a curve are drawn: joined, or each by itself.
enum class PointStyle { line, cross, circle };

/// A text in a frame, centred at a point of its axes.
struct PlotText {
  double x = 0, y = 0;
  std::string text;
};

constexpr int kPlotWidth = 440;  ///< of a frame, in pixels

/// Curves in one frame.
struct Frame {
  PlotAxis y;
  std::vector<std::vector<double>> curves;  ///< y of each, over its x
  int height = 190;
  std::vector<PointStyle> marks = {};  ///< of each curve; fewer: lines
  std::vector<PlotText> texts = {};
};

/// Frames below each other over one x axis.
struct Plot {
  std::string title;    ///< above
  std::string caption;  ///< below
  PlotAxis x;
  std::vector<std::string> labels;          ///< of the curves, for the legend
  std::vector<std::vector<double>> x_data;  ///< of the curves
  std::vector<Frame> frames;
};

/// A `<figure>`: title, legend, one `<svg>`, caption. Every curve keeps its peaks: all values in
/// one column of pixels are drawn as a line from the smallest to the largest.
std::string figure(const Plot& plot);

/// The inside of the `<svg>`, and its size.
struct Drawn {
  std::string svg;
  double width = 0, height = 0;
};
Drawn drawn(const Plot& plot);

/// The same as an SVG file by itself, in the page's light colours, title and legend inside.
std::string standalone(const Plot& plot);

constexpr std::size_t kStyles = 6;  ///< line styles of curves; further curves repeat them

/// Round numbers in [low, high], 3 to 7 of them.
struct Ticks {
  double step = 1;
  std::vector<double> at;
};
Ticks linear_ticks(double low, double high, bool degrees = false);

}  // namespace titop::report
