#include "support/lossy_links.hpp"

#include <doctest/doctest.h>

/// Waves that decay along chains, ladders and grids of bodies, as along rows of spring-masses
/// (lossy_rows.cpp).

using namespace titop;
using titop_test::LossyLinks;

namespace {

void check(const LossyLinks& links) {
  const System system = compile(links.diagram());
  for (const std::complex<double> s : {std::complex<double>(0, 0.7), {0, 160}, {11, 14}}) {
    CAPTURE(links.n);
    CAPTURE(links.modes);
    CAPTURE(links.damping);
    CAPTURE(s);
    // Wrenches across hinges pass without loss: the base's motion is the difference of their terms.
    const double share = links.joint == LossyLinks::Joint::hinge ? 1e-4 : 0;
    CHECK(titop_test::worst_block(system.transfer(s), links.exact(s), share) <= 1e-8);
  }
}

}  // namespace

TEST_CASE("lossy links: hinged chains and chains on bushings, rigid and flexible, of 3 to 80") {
  for (const auto joint : {LossyLinks::Joint::hinge, LossyLinks::Joint::bushing})
    for (const int modes : {0, 2})
      for (const double damping : {0.0, 0.3, 30.0})
        for (const int n : {3, 80})
          check({.n = n, .joint = joint, .modes = modes, .damping = damping});
}

TEST_CASE("lossy links: beams clamped on each other, in a row and as a ladder, of 3 to 80") {
  for (const double damping : {0.0, 0.3, 0.9}) {
    for (const int n : {3, 80})
      check({.n = n, .joint = LossyLinks::Joint::clamp, .damping = damping});
    check({.n = 10, .rails = 2, .joint = LossyLinks::Joint::clamp, .damping = damping});
  }
}

TEST_CASE("lossy links: held or free base, with a force or a prescribed motion at the tip") {
  for (const auto joint : {LossyLinks::Joint::bushing, LossyLinks::Joint::clamp})
    for (const auto base : {LossyLinks::Base::held, LossyLinks::Base::free})
      for (const auto tip : {LossyLinks::Tip::force, LossyLinks::Tip::motion})
        for (const double damping : {0.3, joint == LossyLinks::Joint::clamp ? 0.9 : 1e3})
          check({.n = 40, .joint = joint, .damping = damping, .base = base, .tip = tip});
}

TEST_CASE("lossy links: ladders and grids") {
  for (const int rails : {2, 3})
    for (const double damping : {0.0, 1.0, 30.0})
      for (const int n : {4, 20}) check({.n = n, .rails = rails, .damping = damping});
}
