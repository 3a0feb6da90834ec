// A compiled scene as a document: one HTML page to read on a screen, to print, and to hand over. It
// needs nothing but itself, and Graphviz's dot while it is written.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <titop/titop.hpp>

using namespace titop;

namespace {

/// A hub with an antenna on a driven hinge.
Diagram antenna() {
  Diagram d{"antenna"};
  auto W = d.input("W", 6);   // wrench on the hub [N; N m]
  auto tau = d.input("tau");  // torque of the motor [N m]
  auto hub = d.add("hub", RigidBody{.mass = 120,
                                    .inertia = Vector3d(14, 12, 18).asDiagonal(),
                                    .children = {{"C", {0.4, 0.1, 0.3}}}});
  auto mast =
      d.add("mast", FlexibleBody(Beam{.length = 3,
                                      .section = tube(0.04, 0.036),
                                      .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                      .modes = {.kept = 4, .residual = {"C"}, .xi = {0.005}}}));
  auto dish = d.add("dish", RigidBody{.mass = 4, .inertia = Vector3d(0.3, 0.2, 0.2).asDiagonal()});
  hub.parent.force = -W;
  auto drive = hinge(d, "drive", mast, hub.child("C"), Rotation::about({1, 2, 9}, 0.6), {0, 1, 0});
  drive.torque = 200.0 * drive.angle + 1.5 * drive.rate - tau;
  mount(dish, mast.child("C"));
  d.output("hub", 6) = hub.parent.accel;
  d.output("dish", 6) = dish.parent.accel;
  d.output("angle") = drive.angle;
  return d;
}

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace

int main() {
  const System system = compile(antenna());
  const std::string page = report_html(
      system, {.title = "Antenna on a driven hinge",
               .remark = "For the design review.\nMast: tube 40 x 2 mm, 3 m; drive: 200 N m/rad.",
               .band_hz = {0.1, 200},
               .pairs = {{"angle", "tau"}, {"dish(3)", "tau"}, {"dish(3)", "W(3)"}}});
  std::ofstream("report.html", std::ios::binary) << page;  // write_report does both

  std::printf("report.html: %d sections, %d diagrams, %d plots\n", count(page, "<section"),
              count(page, "<svg class=\"drawing\""), count(page, "<figure class=\"plot\""));
  std::printf("units follow from the inputs and outputs: [rad / (N m)] %s, [m/s² / N] %s\n",
              count(page, "magnitude [rad / (N m)]") ? "yes" : "no",
              count(page, "magnitude [m/s² / N]") ? "yes" : "no");
  std::printf("scripts: %d, addresses elsewhere: %d\n", count(page, "<script"),
              count(page, "http:") + count(page, "https:") + count(page, "src="));
  std::printf("all checks hold: %s\n", count(page, "All checks hold") ? "yes" : "no");

  // One of its pictures by itself: the first mode that bends the mast.
  const std::vector<Pole> poles = system.poles();
  const auto bends = [](const Pole& p) { return p.pair && p.blocks.front().first == "mast"; };
  const auto mode = std::find_if(poles.begin(), poles.end(), bends) - poles.begin();
  write_plot(plot_mode(system, static_cast<int>(mode)), "mode.svg");
  const int place[] = {static_cast<int>(mode)};
  const ModeShapes shapes = mode_shapes(system, place);
  std::printf("mode.svg: %zu points, %zu lines\n", shapes.points.size(), shapes.lines.size());
}
