// Plots as SVG files by themselves.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <titop/titop.hpp>

#include "markup.hpp"
#include "support/folder.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;

namespace {

constexpr double k = 2;

/// x' = -(loop point of k x) + r; a second output for singular values.
System first_order() {
  Diagram d{"first order"};
  auto r = d.input("r");
  auto x = d.add("x", Integrator{});
  x.in = r - d.loop_point("law", k * x.out);
  d.output("y") = x.out;
  d.output("error < 1") = r - k * x.out;
  return compile(d);
}

std::string fault(const std::string& svg) {
  return complaint("<!DOCTYPE html>\n<html>" + svg + "</html>");
}

/// Points of all curves (without marks).
std::vector<std::pair<double, double>> points(const std::string& svg) {
  std::vector<std::pair<double, double>> list;
  for (const std::string& frame : between(svg, "<svg x=", "</svg>"))
    for (const std::string& path : between(frame, "<path class=\"curve c1\" d=\"", "\"")) {
      std::string text = path;
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

}  // namespace

TEST_CASE("a Nyquist curve is where L is: k / s on the imaginary axis") {
  const std::string svg = plot_nyquist(loop(first_order(), "law"));
  CHECK(fault(svg) == "");
  CHECK(svg.find("xmlns=\"http://www.w3.org/2000/svg\"") != std::string::npos);
  const auto curve = points(svg);
  CHECK(curve.size() >= 2);
  for (const auto& [x, y] : curve) {
    CHECK(std::abs(x - 220) <= 0.11);  // 0 in a frame of 440 from -3 to 3
    CHECK(y > 219.9);                  // below the real axis
  }
  CHECK(svg.find("unit circle") != std::string::npos);
  CHECK(svg.find("disk margin 2") != std::string::npos);
}

TEST_CASE("poles and zeros are marks: their number and places") {
  Diagram d{"mode"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4, .damping = 0.4});
  z.parent.accel = 0;
  z.child.force = u;
  d.output("y") = 3.0 * z.stretch + z.child.rate;  // zero at -3
  const std::string svg = plot_poles(compile(d), {.title = "a mode"});
  CHECK(fault(svg) == "");
  CHECK(count(svg, "l8 8m0 -8l-8 8") == 2 + 1);  // and the legend's
  CHECK(count(svg, "a4 4 0 1 0 8 0a4") == 1 + 1);
  CHECK(svg.find("a mode") != std::string::npos);
}

TEST_CASE("Bode, step and singular values; names are escaped") {
  const System system = first_order();
  const std::string bode = plot_bode(system, "y", "r", {.band_hz = {0.01, 10}});
  const std::string step = plot_step(system, "error < 1", "r", {.until = 3});
  const std::string sigma = plot_sigma(system);
  for (const std::string* svg : {&bode, &step, &sigma}) {
    CHECK(fault(*svg) == "");
    CHECK(points(*svg).size() >= 20);
  }
  CHECK(count(bode, "<svg x=") == 2);
  CHECK(step.find("error &lt; 1") != std::string::npos);
  // The gain falls all along the band.
  const auto curve = points(bode);
  CHECK(curve.front().second < curve[curve.size() / 3].second);
}

TEST_CASE("files, and mistakes") {
  const System system = first_order();
  const Folder folder;
  CHECK(error_of([&] { plot_bode(system, "x", "r"); }).has(Code::unknown_name));
  CHECK(error_of([&] { plot_step(system, "y", "q"); }).has(Code::unknown_name));
  CHECK(error_of([&] { plot_bode(system, "y", "r", {.band_hz = {3, 1}}); }).has(Code::bad_value));
  CHECK(error_of([&] { write_plot("<svg/>", "/nowhere/at/all.svg"); }).has(Code::bad_file));
}
