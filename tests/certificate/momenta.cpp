#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/names.hpp"

/// Ports with momenta in the certificate: reciprocity is judged with all momenta reversed.

using namespace titop;
using titop_test::has_line;
using titop_test::has_name;
using titop_test::relative;

TEST_CASE("reversed momenta: the ports that carry them, with their numbers") {
  Diagram d{"wheels"};
  const Param h = d.param("h", 12.5);
  auto hub = d.add("hub", RigidBody{.mass = 50,
                                    .inertia = Vector3d(9, 8, 7).asDiagonal(),
                                    .children = {{"A", {1, 0, 0.5}}, {"B", {0, 1, 0}}}});
  hub.parent.force = -d.input("U", 6);
  const Rotor rotor{.mass = 2, .axial = 0.2, .transverse = 0.15, .axis = {1, 2, 2}, .momentum = h};
  auto wheel = d.add("wheel", rotor);
  auto still = d.add("still", Rotor{.mass = 2, .axial = 0.2, .transverse = 0.15});
  mount(wheel, hub.child("A"), Rotation::about({1, 2, 3}, 0.7));
  mount(still, hub.child("A"));
  wheel.torque = 0;
  still.torque = 0;
  momentum(hub.child("B"), -40, {0, 0, 1});
  d.output("a", 6) = hub.parent.accel;
  const System system = compile(d);
  const auto check = [](const FullCertificate& c, const char* of_wheel, double value) {
    CAPTURE(to_string(c));
    CHECK(c.holds());
    CHECK(c.reciprocity.reversed);
    REQUIRE(c.reciprocity.momenta.size() == 2);
    for (const auto& [port, momentum] : c.reciprocity.momenta) {
      const bool bias = port == "hub.child(\"B\")";
      CHECK((bias || port == "wheel.parent"));
      CHECK(relative(momentum, bias ? 40 : value) <= 1e-12);
    }
    CHECK(has_line(to_string(c),
                   {"6 forces", "40 N m s", "hub.child(\"B\")", of_wheel, "wheel.parent"}));
  };
  check(certify(system), "12.5 N m s", 12.5);
  check(certify(system.update({{"h", 3.0}})), "3 N m s", 3);
  Diagram at_rest{"at rest"};
  auto mass = at_rest.add("mass", SpringMass{.mass = 1, .stiffness = 4});
  ground(mass);
  mass.child.force = at_rest.input("u");
  at_rest.output("a") = mass.child.accel;
  const FullCertificate none = certify(compile(at_rest));
  CHECK(none.reciprocity.momenta.empty());
  CHECK(!has_name(to_string(none), "N m s"));
}
