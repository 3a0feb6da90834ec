#include <doctest/doctest.h>

#include <titop/titop.hpp>

/// A free hub with a beam, torques in, in any units: the order is known by symmetry and momentum.

using namespace titop;

namespace {

/// In units of `unit` metres, kilograms and seconds.
Diagram hub_and_beam(double unit, bool position, const Rotation& mounted = {}) {
  const double length = 1 / unit, mass = 1 / unit, inertia = mass * length * length;
  const double density = mass / (length * length * length), stress = mass / length * unit * unit;
  Diagram d{"hub and beam"};
  auto hub = d.add("hub", RigidBody{.mass = 100 * mass,
                                    .inertia = {50 * inertia, 60 * inertia, 70 * inertia},
                                    .children = {{"C", {length, 0, 0}}}});
  auto beam = d.add(
      "beam", FlexibleBody{Beam{.length = 3 * length,
                                .section = rectangle(0.06 * length, 0.04 * length),
                                .material = {.E = 70e9 * stress, .nu = 0.33, .rho = 2700 * density},
                                .elements = 3}});
  mount(beam, hub.child("C"), mounted);
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -d.input("T", 3);
  if (position)
    d.output("x", 6) = beam.child.position;
  else
    d.output("a", 6) = beam.child.accel;
  return d;
}

}  // namespace

TEST_CASE("torques on a hub with a beam: axial modes stay at rest, in any units") {
  // Six bending modes in each plane and three of torsion; with positions the hub's three angles,
  // whose motion gives its translation, as the centre of mass stays where it is.
  for (const bool position : {false, true})
    for (const double unit : {1e-6, 1.0, 1e6}) {
      CAPTURE(position);
      CAPTURE(unit);
      const OrderVerdict v = compile(hub_and_beam(unit, position)).order_verdict();
      CAPTURE(to_string(v));
      const int order = 30 + (position ? 6 : 0);
      CHECK(v.lowest <= order);
      CHECK(v.highest >= order);
    }
}

TEST_CASE("torques on a hub with a beam mounted askew: order by momentum, in any units") {
  // All 18 modes move, and the hub turns; the centre of mass stays where it is.
  const int order = 2 * (18 + 3);
  for (const double unit : {1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12}) {
    CAPTURE(unit);
    const System system = compile(hub_and_beam(unit, true, Rotation::about({1, 2, 3}, 0.7)));
    CAPTURE(to_string(system.order_verdict()));
    CHECK(system.order_verdict().decided());
    CHECK(system.state_space().order() == order);
    // From 1e-6 of the first bending mode, 42 rad/s, to ten times that.
    for (const double omega : {4e-5, 4e-3, 0.4, 420.0}) {
      CAPTURE(omega);
      const std::complex<double> s = omega * unit * std::complex<double>(0.05, 1);
      const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50),
                             off = system.state_space().transfer(s) - exact;
      for (const int first : {0, 3}) {
        const double size = exact.middleRows(first, 3).norm();
        CHECK(off.middleRows(first, 3).norm() <= 1e-11 * size);
      }
    }
  }
}
