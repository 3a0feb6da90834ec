#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/mistakes.hpp"
#include "support/notes.hpp"

/// Declared but unused parts are reported, and quotations of a diagram are as written.

using namespace titop;
using titop_test::noted;

TEST_CASE("the log names inputs that nothing reads and parameters that nothing depends on") {
  Diagram d{"forgotten"};
  auto u = d.input("u");
  d.input("T2");
  auto shown = d.input("shown");
  const Param tilt = d.param("tilt", 0.3), mass = d.param("mass", 2);
  auto z = d.add("z", SpringMass{.mass = mass, .stiffness = 3});
  ground(z);
  z.child.force = u;
  d.output("x") = z.stretch;
  d.output("through") = 2 * shown;
  const System system = compile(d);
  CHECK(noted(system, Note::Kind::warning, "check", {"T2", "passes/unread.cpp"}));
  CHECK(noted(system, Note::Kind::info, "depend", {"tilt"}));
  for (const char* used : {"u", "shown"}) {
    CAPTURE(used);
    CHECK_FALSE(noted(system, Note::Kind::warning, "check", {used}));
  }
  CHECK_FALSE(noted(system, Note::Kind::info, "depend", {"mass"}));
  (void)tilt;
}

TEST_CASE("an error quotes equations as they were written, all that drive a port") {
  Diagram d{"no mass is left"};
  auto u = d.input("u", 3);
  auto hub = d.add("hub", RigidBody{.mass = 10});
  hub.parent.force.linear = -10 * hub.parent.accel.linear - u;
  hub.parent.force.angular = 0;
  d.output("a", 3) = hub.parent.accel.linear;
  const Error error = titop_test::compile_error(d);
  CHECK(titop_test::says(error, Code::ill_posed,
                         {"hub.parent.force.linear = -10 * hub.parent.accel.linear - u",
                          "hub.parent.force.angular = 0"}));
  CHECK(std::string_view(error.what()).find("M * ") == std::string_view::npos);
}
