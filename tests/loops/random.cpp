#include <doctest/doctest.h>

#include <titop/compiler/passes/passes.hpp>

#include "assembly.hpp"
#include "support/promises.hpp"
#include "support/rng.hpp"

/// Random networks of spring-masses with closed chains: the postconditions of `chains` and `close`,
/// and the transfer of the equations as written.

using namespace loops_test;
using namespace titop;
using titop_test::Rng;

namespace {

/// Each mass is mounted on the ground, on a mass before it, on a shaker or on nothing; some are
/// locked to the ground, some welded to others, some accelerations are integrated.
Diagram network(std::uint64_t seed) {
  Rng rng(seed);
  Diagram d{"network"};
  const int n = 3 + rng.below(6);
  auto u = d.input("u"), v = d.input("v");
  std::vector<SpringMass::Handle> z;
  z.reserve(static_cast<std::size_t>(n));
  const auto any = [&](int below) -> const SpringMass::Handle& {
    return z[static_cast<std::size_t>(rng.below(below))];
  };
  for (int i = 0; i < n; ++i) {
    z.push_back(d.add("z" + std::to_string(i), SpringMass{.mass = rng.between(0.5, 4),
                                                          .stiffness = rng.between(5, 90),
                                                          .parent_mass = rng.between(0.5, 2)}));
    const int kind = rng.below(8);
    if (i > 0 && kind < 5)
      mount(z.back(), any(i).child);
    else if (kind == 5)
      z.back().parent.accel = v;
    else if (kind == 6)
      release(z.back());
    else
      ground(z.back());
  }
  for (int i = 0; i < n; ++i) {
    const int kind = rng.below(5);
    if (kind == 0) z[static_cast<std::size_t>(i)].child.accel = 0;
    if (kind == 1 && i > 0) weld(z[static_cast<std::size_t>(i)].child, any(i).child);
  }
  any(n).child.force += u;
  for (int i = 0; i < 2; ++i) {
    auto rate = d.add("rate" + std::to_string(i), Integrator{});
    auto place = d.add("place" + std::to_string(i), Integrator{});
    rate.in = any(n).child.accel;
    place.in = rate.out;
    d.output("p" + std::to_string(i)) = place.out + rate.out * 2.0;
  }
  d.output("a") = any(n).child.accel;
  return d;
}

}  // namespace

TEST_CASE("random networks with closed chains: order by the null space, transfer as written") {
  int closed = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    const Diagram d = network(seed);
    Stage stage = as_written(d.graph());
    std::string why;
    try {
      for (const auto pass : {passes::check, passes::lower, passes::split, passes::chains})
        stage = pass(std::move(stage));
      titop_test::demand_not_redundant(stage);
      for (const auto pass : {passes::match, passes::order, passes::close})
        stage = pass(std::move(stage));
      titop_test::demand_closed(stage);
      const System system = compile(d, {.minimize_up_to = 0});
      const Complex s{0.7, 5};
      const MatrixXcd G = system.transfer(s);
      CHECK(by_hand::transfer_error({system.state_space().transfer(s)}, {G}) <= 1e-9);
      closed += !stage.dependents.empty();
      if (stage.released.empty())
        CHECK(by_hand::transfer_error({G}, {transfer(d.graph(), s)}) <= 1e-9);
      CHECK(system.certificate().residual <= 1e-9);
    } catch (const std::exception& e) {
      why = e.what();
    }
    CHECK(why == "");
  }
  CHECK(closed >= 100);
}
