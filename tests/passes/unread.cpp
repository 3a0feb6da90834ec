#include <doctest/doctest.h>

#include <titop/titop.hpp>

/// Declared but unused parts are reported, and quotations of a diagram are as written.

using namespace titop;

namespace {

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

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
  const std::string log = compile(d).log();
  CHECK(says(log, "input T2: nothing reads it"));
  CHECK(says(log, "parameter tilt: nothing depends on it"));
  for (const char* used : {"input u:", "input shown:", "parameter mass:"}) {
    CAPTURE(used);
    CHECK_FALSE(says(log, used));
  }
  (void)tilt;
}

TEST_CASE("an error quotes equations as they were written, all that drive a port") {
  Diagram d{"no mass is left"};
  auto u = d.input("u", 3);
  auto hub = d.add("hub", RigidBody{.mass = 10});
  hub.parent.force.linear = -10 * hub.parent.accel.linear - u;
  hub.parent.force.angular = 0;
  d.output("a", 3) = hub.parent.accel.linear;
  try {
    compile(d);
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.has(Code::ill_posed));
    CHECK(says(error.what(), "hub.parent.force.linear = -10 * hub.parent.accel.linear - u"));
    CHECK(says(error.what(), "hub.parent.force.angular = 0"));
    CHECK_FALSE(says(error.what(), "M * "));
  }
}
