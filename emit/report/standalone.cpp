#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/diagram/text.hpp>
#include <titop/emit/report/plot.hpp>

/// A plot as a file of its own.
namespace titop::report {
namespace {

/// As the page's (page.cpp), in its light colours.
constexpr const char* kStyle =
    "text{font:13px sans-serif;fill:#1f2933}.tick{font-size:12px;fill:#52606d}"
    ".over{paint-order:stroke;stroke:#fff;stroke-width:3px}"
    ".title{font-weight:600}path,rect{fill:none}.paper{fill:#fff}"
    ".fine{stroke:#edf1f5;stroke-width:.7}.grid{stroke:#d3dbe3;stroke-width:.8}"
    ".zero{stroke:#52606d}.frame{stroke:#52606d;stroke-width:1.1}"
    ".curve{stroke-linejoin:round}.mark{stroke:#c44e00;stroke-width:1.8}"
    ".c1{stroke:#0b5394;stroke-width:1.9}.c2{stroke:#c44e00;stroke-width:1.7;stroke-dasharray:8 4}"
    ".c3{stroke:#00795a;stroke-width:1.9;stroke-dasharray:2 2.5}"
    ".c4{stroke:#95338c;stroke-width:1.5;stroke-dasharray:11 3 2 3}"
    ".c5{stroke:#7a5c00;stroke-width:2.7;stroke-dasharray:1.5 5}.c6{stroke:#444f8c}";

constexpr double kLine = 20, kColumn = 250;  // [px]

std::string text_at(const char* cls, double x, double y, const std::string& text) {
  return fmt::format(R"(<text class="{}" x="{}" y="{}">{}</text>)", cls, x, y, diagram::html(text));
}

/// Lines of a text that fit into the picture, parted at spaces.
std::vector<std::string> lines_of(const std::string& text) {
  constexpr std::size_t kMost = 84;  // of 6 pixels on average
  std::vector<std::string> lines;
  std::size_t from = 0;
  while (text.size() - from > kMost) {
    std::size_t end = text.rfind(' ', from + kMost);
    if (end == std::string::npos || end <= from) end = std::min(text.find(' ', from), text.size());
    lines.push_back(text.substr(from, end - from));
    from = std::min(end + 1, text.size());
  }
  if (from < text.size()) lines.push_back(text.substr(from));
  return lines;
}

/// The sample of a curve in the legend.
std::string sample(const Plot& plot, std::size_t i, double x, double y) {
  const std::vector<PointStyle>& marks = plot.frames.front().marks;
  const PointStyle mark = i < marks.size() ? marks[i] : PointStyle::line;
  const auto path = [](std::string cls, double px, double py, const char* rest) {
    return fmt::format(R"-(<path class="{}" d="M{} {}{}"/>)-", cls, px, py, rest);
  };
  if (mark == PointStyle::cross) return path("curve mark", x + 14, y - 8, "l8 8m0 -8l-8 8");
  if (mark == PointStyle::circle)
    return path("curve mark", x + 14, y - 4, "a4 4 0 1 0 8 0a4 4 0 1 0 -8 0");
  return path(fmt::format("curve c{}", i % kStyles + 1), x, y - 4, "h34");
}

}  // namespace

std::string standalone(const Plot& plot) {
  const Drawn d = drawn(plot);
  std::string body = text_at("title", 14, 20, plot.title);
  double y = 20;
  for (std::size_t i = 0; i < plot.labels.size(); ++i) {
    const double x = 14 + kColumn * static_cast<double>(i % 2);
    if (i % 2 == 0) y += kLine;
    body += sample(plot, i, x, y) + text_at("tick", x + 42, y, plot.labels[i]);
  }
  const std::vector<std::string> caption = lines_of(plot.caption);
  const double top = y + 8, bottom = kLine * static_cast<double>(caption.size());
  body += fmt::format(R"-(<g transform="translate(0 {})">{}</g>)-", top, d.svg);
  for (std::size_t i = 0; i < caption.size(); ++i)
    body += text_at("tick", 14, top + d.height + 12 + kLine * static_cast<double>(i), caption[i]);
  return fmt::format(
      R"-(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}"><title>{2}</title><style>{3}</style><rect class="paper" width="{0}" height="{1}"/>{4}</svg>)-"
      "\n",
      d.width, top + d.height + bottom, diagram::html(plot.title), kStyle, body);
}

}  // namespace titop::report
