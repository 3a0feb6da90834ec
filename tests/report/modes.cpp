// Pictures of mode shapes: points where the projection puts them, notes, and the report's section.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <titop/titop.hpp>

#include "markup.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;

namespace {

/// A hub of 4 kg with a mass of 1 kg on a spring along z, 2 m away along y.
System hub_with_mass() {
  Diagram d{"hub & mass"};
  auto u = d.input("push");
  auto hub = d.add("hub", RigidBody{.mass = 4, .children = {{"C", Vector3d(0, 2, 0)}}});
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 20});
  hub.parent.accel.angular = 0;
  release(hub);
  mount(z, hub.child("C").along({0, 0, 1}));
  z.child.force += u;
  d.output("x") = z.stretch;
  return compile(d);
}

int oscillation(const System& system) {
  const std::vector<Pole> poles = system.poles();
  for (std::size_t i = 0; i < poles.size(); ++i)
    if (poles[i].pair) return static_cast<int>(i);
  return -1;
}

/// Centres of the circles, in the frame's pixels.
std::vector<std::pair<double, double>> circles(const std::string& svg) {
  std::vector<std::pair<double, double>> list;
  const std::string frame = between(svg, "<svg x=", "</svg>").front();
  for (std::size_t at = frame.find("a4 4 0 1 0 8 0"); at != std::string::npos;
       at = frame.find("a4 4 0 1 0 8 0", at + 1)) {
    const std::size_t from = frame.rfind('M', at) + 1;
    char* end = nullptr;
    const double x = std::strtod(frame.c_str() + from, &end);
    list.emplace_back(x + 4, std::strtod(end, nullptr));
  }
  return list;
}

}  // namespace

TEST_CASE("points of a mode are displaced by 15 % of the structure, seen from x") {
  const System system = hub_with_mass();
  const std::string svg = plot_mode(system, oscillation(system), {.azimuth = 0, .elevation = 0});
  CHECK(complaint("<!DOCTYPE html>\n<html>" + svg + "</html>") == "");
  const auto points = circles(svg);
  REQUIRE(points.size() == 4);  // hub.C, hub.parent, z.child, z.parent
  double left = 1e9, right = 0, top = 1e9, bottom = 0;
  for (const auto& [x, y] : points) {
    left = std::min(left, x), right = std::max(right, x);
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  const double metre = (right - left) / 2;
  // The mass by 0.15 * 2 m, the hub by a quarter of that the other way; places are written to 0.1.
  CHECK(std::abs((bottom - top) - 1.25 * 0.15 * 2 * metre) <= 0.2);
  CHECK(svg.find("hub &amp; mass") == std::string::npos);  // the title is the frequency
  CHECK(svg.find("0.7958 Hz") != std::string::npos);       // sqrt(20 (1 + 1 / 4)) rad/s
  CHECK(svg.find("z.child moves most") != std::string::npos);
}

TEST_CASE("options and poles that are not valid") {
  const System system = hub_with_mass();
  const int mode = oscillation(system);
  CHECK(error_of([&] { plot_mode(system, mode, {.amplitude = 0}); }).has(Code::bad_value));
  CHECK(error_of([&] {
          plot_mode(system, mode, {.azimuth = std::numeric_limits<double>::infinity()});
        }).has(Code::bad_value));
  CHECK(error_of([&] { plot_mode(system, 99); }).has(Code::unknown_name));
}

TEST_CASE("a report shows the modes of a structure, and none of a scalar diagram") {
  const std::string page = report_html(hub_with_mass(), {.diagrams = false});
  CHECK(complaint(page) == "");
  CHECK(page.find("<section id=\"modes\">") != std::string::npos);
  CHECK(page.find("mode of 0.7958 Hz") != std::string::npos);
  CHECK(page.find("displaced") != std::string::npos);

  Diagram d{"scalar"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4});
  ground(z);
  z.child.force = u;
  d.output("x") = z.stretch;
  CHECK(report_html(compile(d), {.diagrams = false}).find("id=\"modes\"") == std::string::npos);
}
