#include <doctest/doctest.h>

#include "generate/diagrams/random_diagram.hpp"
#include "networks.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"

/// Random networks with points without mass against M, D, K: transfer, order, any units.

using namespace index_reduction_test;
using namespace titop;

TEST_CASE("400 random networks with points without mass: transfer and order as by M, D and K") {
  const std::vector<Complex> points = {{0.3, 0.7}, {0.5, 3}, {1, 9}, {0.2, 25}};
  double factored = 0, dense = 0, residual = 0;
  int reduced = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    CAPTURE(seed);
    const Network n = random_network(seed);
    const System system = compile(n.diagram, {.minimize_up_to = 0});
    CHECK(system.order() == n.order);
    reduced += titop_test::noted(system, Note::Kind::info, "reduce");
    std::vector<MatrixXcd> exact, a, b;
    for (const Complex s : points) {
      exact.push_back(by_hand::accel_transfer(n.a, s));
      a.push_back(system.transfer(s)), b.push_back(system.state_space().transfer(s));
    }
    factored = std::max(factored, by_hand::transfer_error(a, exact));
    dense = std::max(dense, by_hand::transfer_error(b, exact));
    residual = std::max(residual, system.certificate().residual);
  }
  MESSAGE(reduced << " reduced; factors " << factored << ", dense " << dense << ", certificate "
                  << residual);
  CHECK(reduced >= 200);
  CHECK(factored <= 1e-12);
  CHECK(dense <= 1e-10);
  CHECK(residual <= 1e-13);
}

TEST_CASE("units of 1e-9 to 1e9 change the verdict on no random scene") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    Rng rng(2000 + seed);
    Units units;
    for (double* factor : {&units.length, &units.mass, &units.time})
      *factor = std::pow(10.0, rng.below(19) - 9);
    const auto scene = titop::generate::random_diagram(titop::generate::random_options(seed));
    System ours = compile(scene.build(), {.minimize_up_to = 0}), theirs = ours;
    REQUIRE_NOTHROW(theirs = compile(scene.build(units), {.minimize_up_to = 0}));
    CHECK(theirs.states() == ours.states());
  }
}

TEST_CASE("units of 1e-9 to 1e9 change neither the order nor the transfer of singular scenes") {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    Rng rng(1000 + seed);
    Units units;
    units.mass = std::pow(10.0, rng.below(19) - 9), units.time = std::pow(10.0, rng.below(19) - 9);
    CAPTURE(units.mass);
    CAPTURE(units.time);
    const Network n = random_network(seed), same = random_network(seed, units);
    const System ours = compile(n.diagram, {.minimize_up_to = 0}),
                 theirs = compile(same.diagram, {.minimize_up_to = 0});
    REQUIRE(theirs.order() == n.order);
    CHECK(theirs.states() == ours.states());
    const Complex s{0.5, 3};  // accelerations by forces: 1 / mass
    worst = std::max(worst, by_hand::transfer_error({theirs.transfer(s / units.time) * units.mass},
                                                    {ours.transfer(s)}));
  }
  CHECK(worst <= 1e-11);
}
