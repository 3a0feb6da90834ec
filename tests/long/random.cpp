#include <doctest/doctest.h>

#include "support/random_checks.hpp"

/// The central property on 1,000 random diagrams, larger ones than the core test has.

using namespace titop::generate;
using namespace titop_test;

TEST_CASE("1000 random graphs: passes, factors, dense model, apply, order of writing, units") {
  const titop::Options plain{.minimize_up_to = 0, .dump_to = {}};
  for (std::uint64_t seed = 10001; seed <= 11000; ++seed) {
    CAPTURE(seed);
    const RandomDiagram scene = random_diagram(random_options(seed, /*larger=*/true));
    PassError pass{1, "threw"};
    CHECK_NOTHROW(pass = pass_error(scene));
    CAPTURE(pass.pass);
    CHECK(pass.worst <= 1e-9);
    SystemError system{1, 1, 1, 0};
    CHECK_NOTHROW(system = system_error(scene));
    CHECK(system.factored <= 1e-9);
    CHECK(system.dense <= (system.stated > 1e-9 ? 1e-8 : 1e-9));
    CHECK(system.apply <= 1e-11);
    double units = 1;
    CHECK_NOTHROW(units = units_error(scene, {.length = 1e3, .mass = 1e-2, .time = 1e2}));
    CHECK(units <= 1e-9);
    CHECK(difference_by_name(titop::compile(scene.build(), plain).state_space(),
                             titop::compile(scene.shuffled(seed), plain).state_space()) == "");
  }
}
