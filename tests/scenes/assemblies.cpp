#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "by_hand.hpp"

/// Trees of bodies and joints against M, D and K assembled by hand.

using namespace scenes_test;
using namespace titop;

namespace {

/// A link of the chain: a beam, the rotation before it, and whether a hinge is in between.
struct Link {
  Tube tube;
  Vector3d axis;
  double angle;
  bool hinged;
  double k, c;
};

/// Links one after the other from a grounded or a free base.
struct Chain {
  std::vector<Link> links;
  bool grounded;
};

constexpr double kBase = 25;  // [kg], and its inertia

Diagram scene(const Chain& chain) {
  Diagram d{"chain"};
  auto base =
      d.add("base",
            RigidBody{.mass = kBase, .inertia = kBase * Matrix3d::Identity(), .children = {{"J"}}});
  if (chain.grounded)
    ground(base);
  else
    base.parent.force = -d.input("W", 6);
  std::vector<BodyHandle> bodies;
  bodies.reserve(chain.links.size());
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    const Link& l = chain.links[i];
    const Rotation T = Rotation::about(l.axis, l.angle);
    const std::string n = std::to_string(i);
    bodies.push_back(d.add("link" + n, FlexibleBody{l.tube.beam()}));
    const auto at = i == 0 ? base.child("J") : bodies[i - 1].child("C");
    if (l.hinged) {
      auto j = hinge(d, "joint" + n, bodies[i], at, T, l.axis);
      j.torque = l.k * j.angle + l.c * j.rate;
    } else {
      mount(bodies[i], at, T);
    }
  }
  bodies.back().child.force = d.input("F", 6);
  if (!chain.grounded) d.output("base", 6) = base.parent.accel;
  d.output("tip", 6) = bodies.back().child.accel;
  return d;
}

/// Coordinates: base (6, if free), then per link the joint's angle and the nodes' elastic motion.
by_hand::Structure assemble(const Chain& chain) {
  Index n = chain.grounded ? 0 : 6;
  for (const Link& l : chain.links) n += (l.hinged ? 1 : 0) + 6 * l.tube.elements;
  const Index ports = chain.grounded ? 6 : 12;
  by_hand::Structure a = by_hand::empty(n, ports, ports);
  MatrixXd tip = MatrixXd::Zero(6, n);
  Index next = 0;
  if (!chain.grounded) {
    tip.leftCols(6).setIdentity();
    a.M.topLeftCorner(6, 6).diagonal().setConstant(kBase);
    a.C.topLeftCorner(6, 6).setIdentity();
    next = 6;
  }
  for (const Link& l : chain.links) {
    const by_hand::Beam beam = l.tube.numbers();
    const by_hand::FreeBeam fe = by_hand::free_beam(beam);
    const Index own = 6 * l.tube.elements;
    MatrixXd root =
        by_hand::dual(Eigen::AngleAxisd(l.angle, l.axis.normalized()).matrix().transpose()) * tip;
    if (l.hinged) {
      root.block(3, next, 3, 1) += l.axis.normalized();
      a.K(next, next) = l.k;
      a.D(next, next) = l.c;
      ++next;
    }
    MatrixXd Y = by_hand::rigid_motion(beam) * root;
    Y.block(6, next, own, own) += MatrixXd::Identity(own, own);
    a.M += Y.transpose() * fe.M * Y;
    a.K.block(next, next, own, own) += fe.K.bottomRightCorner(own, own);
    next += own;
    tip = Y.bottomRows(6);
  }
  a.C.bottomRows(6) = tip;
  a.B = a.C.transpose();
  return a;
}

const Tube kThick{0.9, 0.08, 0.06, 2}, kThin{0.6, 0.03, 0.02, 2};

void compare(const Chain& chain) {
  const System system = compile(scene(chain));
  const by_hand::Structure a = assemble(chain);
  const auto s = points({5, 60, 300, 1200, 6000, 40000});
  std::vector<MatrixXcd> exact;
  for (const Complex z : s) exact.push_back(by_hand::accel_transfer(a, z));
  CHECK(error_3(responses(system, s), exact) <= 1e-11);
  CHECK(error_3(responses(system.state_space(), s), exact) <= 1e-9);
  const by_hand::Structure moving = chain.grounded ? a : by_hand::elastic(a, 6);
  CHECK(system.state_space().order() == 2 * moving.M.rows());
  CHECK(by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(moving)) <= 1e-9);
}

}  // namespace

TEST_CASE("free chain without joints") {
  compare({{{kThick, {1, 2, 0}, 0.8, false, 0, 0}, {kThin, {0, 1, 1}, -1.3, false, 0, 0}}, false});
}

TEST_CASE("free chain with sprung joints") {
  compare({{{kThick, {1, 0, 0}, 0.5, true, 3000, 0},
            {kThin, {0, 1, 1}, 1.0, true, 400, 0},
            {kThin, {0, 0, 1}, -0.4, false, 0, 0}},
           false});
}

TEST_CASE("grounded arm with damped joints") {
  compare({{{kThick, {0, 0, 1}, 0.5, true, 9000, 15},
            {kThick, {0, 1, 0}, 1.0, true, 5000, 8},
            {kThin, {0, 1, 0}, -0.4, true, 700, 1}},
           true});
}

TEST_CASE("symmetric wings: opposite stretching and twisting is not in the model") {
  const Tube wing{2, 0.05, 0.04, 2};
  Diagram d{"symmetric"};
  auto W = d.input("W", 6);
  auto h = d.add("hub", RigidBody{.mass = 30,
                                  .inertia = Vector3d(3, 4, 5).asDiagonal(),
                                  .children = {{"L", {-0.3, 0, 0}}, {"R", {0.3, 0, 0}}}});
  const FlexibleBody body = wing.beam();
  auto left = d.add("left", body), right = d.add("right", body);
  h.parent.force = -W;
  mount(left, h.child("L"), Rotation::about({0, 0, 1}, pi));
  mount(right, h.child("R"));
  d.output("P", 6) = h.parent.accel;
  d.output("F", 6) = right.child.accel;
  const System system = compile(d);
  CHECK(system.order() == 48);
  // 2 axial and 2 torsion modes per wing: their four antiphase combinations stay at rest.
  CHECK(system.state_space().order() == 48 - 2 * 4);
}
