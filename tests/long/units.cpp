#include <doctest/doctest.h>

#include "index_reduction/networks.hpp"
#include "support/random_checks.hpp"

/// 10,000 random changes of all units by factors from 1e-9 to 1e9: no verdict flips.

using namespace titop;
using titop::generate::Units;
using titop_test::Rng;

namespace {

Units random_units(Rng& rng) {
  const auto factor = [&] { return std::pow(10.0, rng.below(19) - 9); };
  const double length = factor(), mass = factor();
  return {.length = length, .mass = mass, .time = factor()};
}

/// Results of `compile` and `minimize`: the order and its interval, or the code of the refusal.
struct Said {
  std::string text;  ///< "12", or the code
  int lowest = 0, order = 0, highest = 0;

  explicit Said(const Diagram& d, int minimize_up_to = 0) {
    try {
      const System system = compile(d, {.minimize_up_to = minimize_up_to});
      text = std::to_string(system.order());
      if (minimize_up_to == 0) return;
      const OrderVerdict v = system.order_verdict();
      lowest = v.lowest, order = v.order, highest = v.highest;
    } catch (const Error& e) {
      text = std::string(to_string(e.mistakes().front().code));
    }
  }
  bool meets(const Said& other) const {
    return std::max(lowest, other.lowest) <= std::min(highest, other.highest);
  }
};

std::string verdict(const Diagram& d) { return Said(d).text; }

/// m a = k a + u - ...: singular if k = m, in any unit.
Diagram cancelled(double mass, const Units& u, double share) {
  Diagram d{"cancelled"};
  auto z =
      d.add("z", SpringMass{.mass = mass * u.mass, .stiffness = 26 * u.mass / (u.time * u.time)});
  auto K = d.add("K", Lti{.D = Eigen::MatrixXd::Constant(1, 1, share * (mass * u.mass))});
  ground(z);
  K.in = z.child.accel;
  z.child.force = d.input("u") + K.out;
  d.output("a") = z.child.accel;
  return d;
}

}  // namespace

TEST_CASE("10,000 changes of units: random scenes, points without mass, feedthroughs that cancel") {
  for (std::uint64_t seed = 1; seed <= 10000; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const Units units = random_units(rng);
    if (seed % 4 == 0) {
      const auto scene =
          titop::generate::random_diagram(titop::generate::random_options(seed % 400));
      CHECK(verdict(scene.build(units)) == verdict(scene.build()));
    } else if (seed % 4 == 1) {
      const double share = seed % 8 == 1 ? 1 : 1 - 1e-13;
      CHECK(verdict(cancelled(rng.octaves(-3, 3), units, share)) ==
            (share == 1 ? "improper" : "2"));
    } else {
      const auto network = index_reduction_test::random_network(seed, units);
      CHECK(verdict(network.diagram) == std::to_string(network.order));
    }
  }
}

TEST_CASE("10,000 changes of units: the certain part of the minimal order") {
  int all = 0, other_interval = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    const auto scene = titop::generate::random_diagram(titop::generate::random_options(seed));
    const Said here(scene.build(), 100);
    Rng rng(seed);
    for (int k = 0; k < 10; ++k) {
      CAPTURE(seed);
      CAPTURE(k);
      const Said there(scene.build(random_units(rng)), 100);
      CHECK(there.text == here.text);
      // The true order is in both. An undecided one keeps states which other arithmetic, or exact
      // counting, shows to be superfluous: it need not be in a decided interval.
      CHECK(here.meets(there));
      ++all, other_interval += here.lowest != there.lowest || here.highest != there.highest;
    }
  }
  CHECK(all == 10000);
  CHECK(other_interval * 100 <= all);
}
