#include "support/four_bar.hpp"

#include <titop/blocks/hinge.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/graph/mount.hpp>

namespace titop_test {

using namespace titop;

Diagram diagram(const FourBar& f) {
  Diagram d{"four_bar"};
  const Vector3d z(0, 0, 1);
  auto base = d.add("base", RigidBody{.children = {{"A"}, {"D", f.base}}});
  ground(base);
  const auto link = [&](const char* name, double length, double mass) {
    return d.add(name, RigidBody{.mass = mass,
                                 .inertia = {0.1, 0.1, 0.1},
                                 .PA = {length / 2, 0, 0},
                                 .children = {{"C", {length, 0, 0}}}});
  };
  auto crank = link("crank", f.crank, 2), coupler = link("coupler", f.coupler, 3),
       rocker = link("rocker", f.rocker, 2);
  auto a = hinge(d, "a", crank, base.child("A"), Rotation::about(z, f.crank_angle), z);
  a.torque = FourBar::kStiffness * a.angle - d.input("u");
  hinge(d, "b", coupler, crank.child, Rotation::about(z, -f.crank_angle), z).torque = 0;
  auto c = hinge(d, "c", rocker, base.child("D"), Rotation::about(z, f.rocker_angle), z);
  c.torque = 0;
  auto end = d.add("end", Hinge{z});
  mount(end, rocker.child, Rotation::about(z, -f.rocker_angle));
  weld(coupler.child, end.child);
  end.torque = 0;
  d.output("crank") = a.angle;
  d.output("rocker") = c.angle;
  return d;
}

}  // namespace titop_test
