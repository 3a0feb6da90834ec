#include <doctest/doctest.h>

#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/mount.hpp>

#include "support/promises.hpp"
#include "support/random_checks.hpp"

/// The central property, on 200 seeded random diagrams: every pass keeps the transfer and satisfies
/// its own postcondition, and the compiled system agrees with the equations as written.

using namespace titop::generate;
using namespace titop_test;

namespace {

constexpr std::uint64_t kScenes = 200;

titop::Stage lowered(const titop::Diagram& d) {
  return titop::passes::lower(titop::passes::check(titop::as_written(d.graph())));
}

}  // namespace

TEST_CASE("random graphs: every pass keeps the transfer to 1e-9, and its promise") {
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    CAPTURE(seed);
    PassError error{1, "threw"};
    CHECK_NOTHROW(error = pass_error(random_diagram(random_options(seed))));
    CAPTURE(error.pass);
    CHECK(error.worst <= 1e-9);
  }
}

TEST_CASE("random graphs: factors, dense model and apply agree with the equations to 1e-9") {
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    CAPTURE(seed);
    SystemError error{1, 1, 1};
    CHECK_NOTHROW(error = system_error(random_diagram(random_options(seed))));
    CHECK(error.factored <= 1e-9);
    CHECK(error.dense <= 1e-9);
    CHECK(error.apply <= 1e-11);
  }
}

TEST_CASE("random graphs: the minimized model has the same transfer to 1e-9") {
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed)
    for (const Damping damping : {Damping::some, Damping::all}) {
      RandomOptions options = random_options(seed);
      if (damping == Damping::all) options.damping = damping, options.controllers = false;
      CAPTURE(seed);
      CAPTURE(options.controllers);
      double error = 1;
      CHECK_NOTHROW(error = minimize_error(random_diagram(options)));
      CHECK(error <= 1e-9);
    }
}

TEST_CASE("promises of split and close: broken before the pass") {
  titop::Diagram d{"two"};
  auto u = d.input("u");
  auto a = d.add("a", titop::SpringMass{}), b = d.add("b", titop::SpringMass{});
  auto alone = d.add("alone", titop::SpringMass{});
  ground(a), ground(alone);
  mount(b, a.child);
  b.child.force = u;
  d.output("x") = b.position;
  CHECK_THROWS(demand_split(lowered(d)));
  CHECK_NOTHROW(demand_split(titop::passes::split(lowered(d))));
  CHECK_NOTHROW(demand_not_redundant(lowered(d)));
  CHECK_NOTHROW(demand_closed(lowered(d)));
  alone.child.accel = 0;  // between two walls: one stretch, and it is 0
  CHECK_NOTHROW(demand_not_redundant(lowered(d)));
  CHECK_THROWS(demand_closed(lowered(d)));
}

TEST_CASE("random graphs: the generator covers its promises") {
  int no_input = 0, no_output = 0, removed = 0, inverted = 0, loops = 0, unchecked = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    const titop::System system = titop::compile(random_diagram(random_options(seed)).build(),
                                                {.minimize_up_to = 0, .dump_to = {}});
    no_input += system.inputs().empty();
    no_output += system.outputs().empty();
    for (const titop::Note& note : system.notes()) {
      removed += note.kind == titop::Note::Kind::removed;
      inverted += note.kind == titop::Note::Kind::inverted;
      unchecked += note.kind == titop::Note::Kind::unchecked;
    }
    for (const titop::Loop& loop : system.stage().loops) loops += loop.signals.size() > 1;
  }
  CHECK(no_input >= 1);
  CHECK(no_output >= 1);
  CHECK(removed >= 20);
  CHECK(inverted >= 50);
  CHECK(loops >= 50);
  CHECK(unchecked == 0);  // every rotation has its frames
}
