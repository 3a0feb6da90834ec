#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/close.hpp"

/// Results of a System that is a temporary stay valid: such lines are written everywhere.

using namespace titop;

namespace {

Diagram one_mass() {
  Diagram d{"one"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 50});
  ground(z);
  z.child.force = u;
  d.output("a") = z.child.accel;
  return d;
}

Scene scene() {
  return {.inputs = {"u"}, .outputs = {"a"}, .band_hz = {0, 10}, .damping_floor = 0.01};
}

}  // namespace

#define STAYS(type, call)                                                           \
  static_assert(!std::is_reference_v<decltype(std::declval<type>().call())>);       \
  static_assert(!std::is_reference_v<decltype(std::declval<const type>().call())>); \
  static_assert(std::is_reference_v<decltype(std::declval<const type&>().call())>)

STAYS(System, states);
STAYS(System, inputs);
STAYS(System, outputs);
STAYS(System, state_space);
STAYS(System, order_verdict);
STAYS(System, notes);
STAYS(System, seconds);
STAYS(System, stage);
STAYS(ReducedSystem, inputs);
STAYS(ReducedSystem, outputs);
STAYS(ReducedSystem, full);
STAYS(ReducedSystem, scene);
STAYS(ReducedSystem, bound);
STAYS(ReducedSystem, notes);
STAYS(ReducedSystem, steps);
STAYS(ReducedSystem, modes);
STAYS(ReducedSystem, seconds);

TEST_CASE("a model bound to a reference outlives the System that it is of") {
  const StateSpace& m = compile(one_mass()).state_space();
  CHECK(titop_test::relative(m.A.determinant(), 25.0) <= 1e-14);  // k / m
  CHECK(m.D(0, 0) == 0.5);
  for (const std::string& name : compile(one_mass()).inputs()) CHECK(name == "u");
  const Graph& graph = compile(one_mass()).stage().graph;
  CHECK(graph.outputs.size() == 1);
}

TEST_CASE("a reduced system's full one outlives it") {
  const System& full = compile(one_mass(), scene()).full();
  CHECK(full.order() == 2);
}

TEST_CASE("points along a chain are kept in a list: ports are no names to assign") {
  static_assert(!std::is_copy_assignable_v<DualPort<6>>);
  const RigidBody link{.mass = 2, .PA = {0.5, 0, 0}, .children = {{"C", {1, 0, 0}}}};
  const auto chain = [&](bool by_list) {
    Diagram d{"chain"};
    auto hub = d.add("hub", RigidBody{.mass = 9, .children = {{"L", {0, 1, 0}}}});
    hub.parent.force = -d.input("W", 6);
    auto a = d.add("a", link), b = d.add("b", link);
    if (by_list) {
      std::vector<DualPort<6>> sites{hub.child("L")};
      for (const BodyHandle& body : {a, b}) {
        mount(body, sites.back());
        sites.push_back(body.child);
      }
      d.output("tip", 6) = sites.back().accel;
    } else {
      mount(a, hub.child("L"));
      mount(b, a.child);
      d.output("tip", 6) = b.child.accel;
    }
    return compile(d).static_gain();
  };
  CHECK(chain(true) == chain(false));
}

TEST_CASE("a parameter of a diagram that is gone is refused, whatever its address was") {
  for (int k = 0; k < 50; ++k) {
    const SpringMass spec = [] {
      Diagram other{"other"};
      other.param("unused", 1);
      return SpringMass{.mass = other.param("m", 7), .stiffness = 1};
    }();
    Diagram d{"mine"};
    d.param("a", 1);
    d.param("b", 99);
    auto y = d.add("y", spec);
    ground(y);
    y.child.force = d.input("u");
    d.output("q") = y.stretch;
    CHECK_THROWS_AS(compile(d), Error);
  }
}
