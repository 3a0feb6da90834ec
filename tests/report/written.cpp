// "As written" in the report is the user's diagram: no Integrator that the compiler has added.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <titop/emit/report/written.hpp>
#include <titop/titop.hpp>

#include "markup.hpp"
#include "support/skip.hpp"

using namespace titop;
using namespace titop_test;
namespace report = titop::report;

namespace {

/// A free hub, steered by its own attitude, which is no state; and an Integrator of the user's.
Diagram steered() {
  Diagram d{"steered"};
  auto hub = d.add("hub", RigidBody{.mass = 10, .children = {{"C", {1, 0, 0}}}});
  auto arm = d.add("arm", RigidBody{.mass = 2});
  auto law = d.add("law", Gain{.gain = -3, .size = 3});
  auto sum = d.add("a sum", Integrator{.size = 3});
  mount(arm, hub.child("C"), Rotation::about({0, 0, 1}, 0.5));
  law.in = hub.parent.position.angular();
  sum.in = arm.parent.accel.linear;
  hub.parent.force.linear = 0;
  hub.parent.force.angular = law.out - d.input("T", 3);
  d.output("attitude", 3) = hub.parent.position.angular();
  d.output("speed", 3) = sum.out;
  return d;
}

}  // namespace

TEST_CASE("the diagram as written can be recovered from the compiled system") {
  const Diagram d = steered();
  const System system = compile(d);
  REQUIRE(system.stage().motions.size() == 2);  // rate and position
  const Graph g = report::written(system.stage());
  CHECK(g.nodes.size() == d.graph().nodes.size());
  CHECK(g.signals.size() == d.graph().signals.size());
  CHECK(g.equations.size() == d.graph().equations.size());
  CHECK(to_dot(as_written(g)) == to_dot(d));
  for (const int fold : {1, 2, 3})
    CHECK(to_dot(as_written(g), {.fold = fold}) == to_dot(d, {.fold = fold}));
  for (std::size_t n = 0; n < g.nodes.size(); ++n)
    for (int s = g.nodes[n].first_signal; s < g.nodes[n].end_signal; ++s) {
      const Signal& signal = g.signals[static_cast<std::size_t>(s)];
      CHECK(signal.node == static_cast<int>(n));
      CHECK((signal.frame < 0 || signal.frame == static_cast<int>(n)));
    }
}

TEST_CASE("the report counts and draws the user's blocks") {
  const std::string scene = section(report_html(compile(steered()), {.diagrams = false}), "scene");
  const auto rows = between(scene, "<tr>", "</tr>");
  const auto counted = [&](const std::string& type, const char* number) {
    return std::count_if(rows.begin(), rows.end(), [&](const std::string& row) {
      return has(row, ">" + type + "</td>") && has(row, ">" + std::string(number) + "</td>");
    });
  };
  CHECK(counted("Integrator", "1") == 1);
  CHECK(counted("RigidBody", "2") == 1);
  if (std::system("dot -V >/dev/null 2>&1") != 0)
    return titop_test::skip("dot (Graphviz) is not installed");
  const auto drawings = between(section(report_html(compile(steered())), "scene"),
                                "<svg class=\"drawing\"", "</svg>");
  REQUIRE(drawings.size() == 2);
  CHECK(!has(drawings[0], "angular_rate"));
  CHECK(!has(drawings[0], "angular_position"));
  CHECK(has(drawings[1], ">hub.parent.angular_rate</text>"));
}
