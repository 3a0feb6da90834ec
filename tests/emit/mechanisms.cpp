// Mechanisms with rotors as users hand them on: generated code, report, drawing and file.
#include <doctest/doctest.h>

#include <array>
#include <string>
#include <titop/titop.hpp>

#include "../../examples/scenes/cmg.hpp"
#include "../../examples/scenes/sloshing.hpp"
#include "../../examples/scenes/solar_array_drive.hpp"
#include "../../examples/scenes/wheels.hpp"
#include "report/markup.hpp"
#include "support/folder.hpp"

using namespace titop;
using namespace titop_test;

namespace {

std::string warnings(const std::vector<Note>& notes) {
  std::string text;
  for (const Note& n : notes)
    if (n.kind == Note::Kind::warning) text += n.pass + ": " + n.text + "\n";
  return text;
}

/// Reduced within its bound without a warning, also as generated code.
void check_scene(const Diagram& d, std::array<double, 2> band_hz) {
  const Scene scene{.band_hz = band_hz, .accuracy = 1e-3};
  const ReducedSystem r = compile(d, scene);
  CAPTURE(to_string(r));
  CHECK(warnings(r.notes()) == "");
  CHECK(warnings(r.full().notes()) == "");
  CHECK(r.bound().worst <= scene.accuracy);
  CHECK(generate_cpp(compile(diagram_of_model(r.state_space(), "reduced"), {.minimize_up_to = 0}))
            .error <= 1e-6);
}

/// Compiles without a warning, also by its file, as generated code, in the report and for a scene.
void check_handed_on(const Diagram& d, std::array<double, 2> band_hz) {
  CAPTURE(d.graph().name);
  check_scene(d, band_hz);
  const System system = compile(d), read = compile(parse_diagram(diagram_json(d)));
  CHECK(warnings(system.notes()) == "");
  CHECK(warnings(system.dense_notes()) == "");
  for (const std::complex<double> s : {std::complex<double>(0.1, 0.4), {0.3, 20}})
    CHECK(read.transfer(s) == system.transfer(s));
  CHECK(generate_cpp(system).error <= 1e-6);
  const Folder folder;
  write_report(system, folder.path / "report.html", {.diagrams = false, .full_up_to = 0});
  const std::string page = folder.read("report.html");
  CHECK(complaint(page) == "");
  for (const Verdict& v : verdicts(page)) CHECK(v.cls != "bad");
}

}  // namespace

TEST_CASE("a wheel with momentum in header, report and drawing") {
  Diagram d{"one wheel"};
  auto hub = d.add("hub", RigidBody{.mass = 100,
                                    .inertia = Vector3d(40, 50, 60).asDiagonal(),
                                    .children = {{"W", {0.1, 0, 0.2}}}});
  auto wheel =
      d.add("wheel",
            Rotor{.mass = 5, .axial = 0.08, .transverse = 0.05, .axis = {0, 1, 0}, .momentum = 40});
  mount(wheel, hub.child);
  hub.parent.force = -d.input("U", 6);
  wheel.torque = 1e-3 * wheel.speed - d.input("motor");
  d.output("rate", 3) = hub.parent.rate.angular();
  d.output("accel", 6) = hub.parent.accel;
  d.output("spin") = wheel.accel;
  const System system = compile(d);
  CHECK(generate_cpp(system).error <= 1e-6);
  const std::string page = report_html(system, {.diagrams = false}), dot = to_dot(system.stage());
  CHECK(has(section(page, "certificate"), "reversed"));
  CHECK(has(section(page, "poles"), "wheel"));
  // The box of the rotor, and the torque on its carrier from the carrier's rate.
  CHECK(has(dot, "<B>wheel</B>"));
  CHECK(has(dot, "Rotor, 2 states"));
  CHECK(has(dot, "\"hub.parent.angular_rate\":o0:s -> \"gain hub.child(\\\"W\\\").force"));
}

TEST_CASE("the mechanisms of the examples compile without a warning, and are handed on") {
  check_handed_on(scenes::wheels::satellite(0, scenes::wheels::Motors::law), {0.01, 5});
  check_handed_on(scenes::wheels::satellite(40, scenes::wheels::Motors::off), {0.01, 5});
  check_handed_on(scenes::wheels::satellite(40, scenes::wheels::Motors::off, true), {0, 40});
  check_handed_on(scenes::wheels::satellite(40, scenes::wheels::Motors::law), {0.01, 5});
  check_handed_on(scenes::wheels::satellite(40, scenes::wheels::Motors::dumping), {0.01, 5});
  check_handed_on(scenes::cmg::cluster(), {0.01, 30});
  check_handed_on(scenes::solar_array_drive::satellite(), {0.01, 30});
  for (const auto model : {scenes::sloshing::Liquid::springs, scenes::sloshing::Liquid::pendulum})
    check_handed_on(scenes::sloshing::satellite(model), {0.01, 5});
}
