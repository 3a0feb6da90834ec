// Plots as SVG files by themselves; curves are compared with closed forms at the ticks' numbers.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <titop/titop.hpp>

#include "curves.hpp"
#include "markup.hpp"
#include "support/folder.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;
using std::numbers::pi;

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

/// G(s) = V diag(1 / (s + 1), 3 / (s + 5)) V', V a rotation.
System two_gains() {
  const Eigen::Matrix2d V = Eigen::Rotation2Dd(0.4).toRotationMatrix();
  Diagram d{"two gains"};
  auto g = d.add("g", Lti{.A = Eigen::Vector2d(-1, -5).asDiagonal(),
                          .B = V.transpose(),
                          .C = V * Eigen::Vector2d(1, 3).asDiagonal()});
  g.in = d.input("u", 2);
  d.output("y", 2) = g.out;
  return compile(d);
}

std::string fault(const std::string& svg) {
  return complaint("<!DOCTYPE html>\n<html>" + svg + "</html>");
}

}  // namespace

TEST_CASE("a Nyquist curve is where L is: k / s on the imaginary axis") {
  const std::string svg = plot_nyquist(loop(first_order(), "law"));
  CHECK(fault(svg) == "");
  CHECK(svg.find("xmlns=\"http://www.w3.org/2000/svg\"") != std::string::npos);
  const auto curve = curve_of(frames_of(svg).front());
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

TEST_CASE("Bode: 1 / (s + 2), magnitude and phase at every point of the curves") {
  const std::string svg = plot_bode(first_order(), "y", "r", {.band_hz = {0.01, 10}});
  CHECK(fault(svg) == "");
  CHECK(frames_of(svg).size() == 2);
  CHECK(distance(svg, 0, "c1", true, true,
                 [](double hertz) { return 1 / std::hypot(2 * pi * hertz, k); }) <= kRounded);
  CHECK(distance(svg, 1, "c1", true, false, [](double hertz) {
          return -std::atan(2 * pi * hertz / k) * 180 / pi;
        }) <= kRounded);
}

TEST_CASE("step: exp(-2 t) at every point of the curve; names are escaped") {
  const std::string svg = plot_step(first_order(), "error < 1", "r", {.until = 3});
  CHECK(fault(svg) == "");
  CHECK(svg.find("error &lt; 1") != std::string::npos);
  CHECK(distance(svg, 0, "c1", false, false, [](double t) { return std::exp(-k * t); }) <=
        kRounded);
}

TEST_CASE("singular values of two directions: the larger gain first, also where they change") {
  const std::string svg = plot_sigma(two_gains(), {.band_hz = {0.01, 10}});
  CHECK(fault(svg) == "");
  const auto one = [](double hertz) { return 1 / std::hypot(2 * pi * hertz, 1); };
  const auto other = [](double hertz) { return 3 / std::hypot(2 * pi * hertz, 5); };
  CHECK(one(0.01) > other(0.01));
  CHECK(one(10) < other(10));
  CHECK(distance(svg, 0, "c1", true, true, [&](double f) { return std::max(one(f), other(f)); }) <=
        kRounded);
  CHECK(distance(svg, 0, "c2", true, true, [&](double f) { return std::min(one(f), other(f)); }) <=
        kRounded);
}

TEST_CASE("files, and mistakes") {
  const System system = first_order();
  const Folder folder;
  CHECK(error_of([&] { plot_bode(system, "x", "r"); }).has(Code::unknown_name));
  CHECK(error_of([&] { plot_step(system, "y", "q"); }).has(Code::unknown_name));
  CHECK(error_of([&] { plot_bode(system, "y", "r", {.band_hz = {3, 1}}); }).has(Code::bad_value));
  CHECK(error_of([&] { write_plot("<svg/>", "/nowhere/at/all.svg"); }).has(Code::bad_file));
}
