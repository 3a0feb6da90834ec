#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>

#include "assembly.hpp"
#include "support/rng.hpp"

/// Random chains in space that close over a free hub, with sprung hinges, of rigid bodies and
/// beams, many of them over-constrained: orders and transfers as by M, D and K of all separate
/// bodies, on the null space of all joint constraints.

using namespace loops_test;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using titop_test::Rng;

namespace {

/// A link from one pin to the next.
struct Link {
  Matrix3d R;  ///< its frame, to the world's
  bool beam = false;
  double mass = 1, length = 1;
  Vector3d PA;  ///< in its frame

  Matrix3d inertia() const { return mass * Vector3d(0.2, 0.3, 0.4).asDiagonal(); }
  Tube tube() const { return {length, 0.05, 0.04, 1}; }
};

/// Links and pins in turn: pin 0 and the last one are on the hub, whose point P is the origin.
struct Chain {
  Link hub;
  std::vector<Link> links;
  std::vector<Vector3d> pins, axes;
  std::vector<double> stiffness;
  int watched = 0;  ///< a link: pushed and watched at its far end
};

Link link(Rng& rng, bool beam) {
  return {rng.rotation(), beam, rng.between(1, 5), 1, 0.3 * Vector3d(rng.matrix(3, 1))};
}

/// `planar`: pins in a plane, all axes across it.
Chain random_chain(Rng& rng, bool planar) {
  Chain c;
  const int count = 2 + rng.below(planar ? 4 : 6);
  c.hub = link(rng, false);
  const Matrix3d world = rng.rotation();
  for (int i = 0; i <= count; ++i) {
    Vector3d pin = rng.matrix(3, 1) * 2, axis = rng.rotation().col(2);
    if (planar) pin(2) = 0.4, axis = Vector3d::UnitZ();
    c.pins.push_back(world * pin);
    c.axes.push_back(world * axis);
    c.stiffness.push_back(rng.between(20, 200));
  }
  for (int i = 0; i < count; ++i) {
    const Vector3d way =
        c.pins[static_cast<std::size_t>(i) + 1] - c.pins[static_cast<std::size_t>(i)];
    Link l = link(rng, rng.chance(0.3));
    l.length = way.norm();
    if (l.beam) l.R = along_x(way, l.R);
    c.links.push_back(l);
  }
  c.watched = rng.below(count);
  return c;
}

constexpr double kDamping = 0.01;  ///< of each hinge: c / k [s]

titop::BodyHandle add(titop::Diagram& d, const std::string& name, const Link& l,
                      const std::vector<titop::ChildPoint>& children) {
  if (l.beam) return d.add(name, titop::FlexibleBody{l.tube().beam()});
  return d.add(name, titop::RigidBody{
                         .mass = l.mass, .inertia = l.inertia(), .PA = l.PA, .children = children});
}

titop::Diagram diagram(const Chain& c) {
  titop::Diagram d{"chain"};
  const std::size_t count = c.links.size();
  const auto U = d.input("U", 6), F = d.input("F", 6);
  const Matrix3d& hub_R = c.hub.R;
  const titop::BodyHandle hub =
      add(d, "hub", c.hub,
          {{"first", hub_R.transpose() * c.pins[0]}, {"last", hub_R.transpose() * c.pins[count]}});
  hub.parent.force = -U;
  std::vector<titop::BodyHandle> b;
  std::vector<titop::Hinge::Handle> hinges;
  for (std::size_t i = 0; i < count; ++i) {
    const Link& l = c.links[i];
    b.push_back(add(d, "b" + std::to_string(i), l,
                    {{"end", l.R.transpose() * (c.pins[i + 1] - c.pins[i])}}));
    const Matrix3d& site_R = i ? c.links[i - 1].R : hub_R;
    const titop::DualPort<6> site = i ? titop::DualPort<6>(b[i - 1].child) : hub.child("first");
    hinges.push_back(hinge(d, "h" + std::to_string(i), b[i], site,
                           titop::Rotation::matrix(site_R.transpose() * l.R),
                           l.R.transpose() * c.axes[i]));
  }
  hinges.push_back(d.add("closing", titop::Hinge{hub_R.transpose() * c.axes[count]}));
  mount(hinges[count], b[count - 1].child,
        titop::Rotation::matrix(c.links[count - 1].R.transpose() * hub_R));
  weld(hinges[count].child, hub.child("last"));
  for (std::size_t i = 0; i <= count; ++i)
    hinges[i].torque =
        c.stiffness[i] * hinges[i].angle + kDamping * c.stiffness[i] * hinges[i].rate;
  const auto end = b[static_cast<std::size_t>(c.watched)].child;
  end.force += F;
  d.output("hub", 6) = hub.parent.accel;
  d.output("end", 6) = end.accel;
  return d;
}

/// All bodies by themselves: rigid ones with six coordinates, beams with twelve, in their frames.
struct ByHand {
  Assembly all;
  std::vector<MatrixXd> start, end;  ///< motion of each link's pins (6 x n), in its frame
  MatrixXd held;                     ///< rows that are 0

  static Index size(const Chain& c) {
    Index n = 6;
    for (const Link& l : c.links) n += l.beam ? 12 : 6;
    return n;
  }
  explicit ByHand(const Chain& c) : all(size(c), 12, 12), held(0, size(c)) {
    all.add(mass_at_P(c.hub.mass, c.hub.inertia(), c.hub.PA), MatrixXd::Zero(6, 6), all.unit(0, 6));
    Index first = 6;
    for (std::size_t i = 0; i < c.links.size(); ++i) {
      const Link& l = c.links[i];
      start.push_back(all.unit(first, 6));
      if (l.beam) {
        end.push_back(all.unit(first + 6, 6));
        all.beam(l.tube().numbers(), start.back(), end.back(), first + 12);
      } else {
        end.push_back(by_hand::tau(l.R.transpose() * (c.pins[i] - c.pins[i + 1])) * start.back());
        all.add(mass_at_P(l.mass, l.inertia(), l.PA), MatrixXd::Zero(6, 6), start.back());
      }
      first += l.beam ? 12 : 6;
    }
    for (std::size_t i = 0; i < c.pins.size(); ++i) pin(c, i);
    const auto w = static_cast<std::size_t>(c.watched);
    all.a.C << all.unit(0, 6), end[w];
    all.a.B = all.a.C.transpose();
  }

  /// In the world's frame: displacements are the same on both sides, turns but about the axis.
  void pin(const Chain& c, std::size_t i) {
    const auto of_hub = [&](std::size_t p) {
      const Vector3d there = c.hub.R.transpose() * c.pins[p];
      return MatrixXd(by_hand::dual(c.hub.R) * by_hand::tau(-there) * all.unit(0, 6));
    };
    const std::size_t last = c.links.size();
    const MatrixXd below = i ? MatrixXd(by_hand::dual(c.links[i - 1].R) * end[i - 1]) : of_hub(0),
                   above =
                       i < last ? MatrixXd(by_hand::dual(c.links[i].R) * start[i]) : of_hub(last);
    const MatrixXd apart = above - below;
    const Matrix3d frame = along_x(c.axes[i], c.hub.R);
    MatrixXd rows(5, apart.cols());
    rows << apart.topRows(3), frame.rightCols(2).transpose() * apart.bottomRows(3);
    held.conservativeResize(held.rows() + 5, held.cols());
    held.bottomRows(5) = rows;
    const MatrixXd angle = frame.col(0).transpose() * apart.bottomRows(3);
    all.a.K += c.stiffness[i] * angle.transpose() * angle;
    all.a.D += kDamping * c.stiffness[i] * angle.transpose() * angle;
  }
};

void compare(bool planar, int seeds, int& redundant, int& beams) {
  for (int seed = 0; seed < seeds; ++seed) {
    CAPTURE(planar);
    CAPTURE(seed);
    Rng rng(static_cast<std::uint64_t>(seed));
    const Chain chain = random_chain(rng, planar);
    const ByHand by_hand(chain);
    const Constraints constraints(by_hand.held);
    if (!constraints.clear) continue;
    const by_hand::Structure exact = constrained(by_hand.all.a, constraints);
    const titop::System system = titop::compile(diagram(chain));
    CHECK(system.order() == 2 * (exact.M.rows() - 6));
    const std::vector<Complex> s = points({2, 30, 400});
    std::vector<MatrixXcd> by_hand_at;
    for (const Complex z : s) by_hand_at.push_back(by_hand::accel_transfer(exact, z));
    CHECK(error_3(responses(system, s), by_hand_at) <= 1e-8);
    CHECK(error_3(responses(system.state_space(), s), by_hand_at) <= 1e-7);
    redundant += !system.stage().released.empty();
    for (const Link& l : chain.links) beams += l.beam;
  }
}

}  // namespace

TEST_CASE("150 chains in space and 150 in a plane: orders and transfers as by M, D and K") {
  int redundant = 0, beams = 0;
  compare(false, 150, redundant, beams);
  CHECK(beams > 100);
  compare(true, 150, redundant, beams);
  CHECK(redundant > 50);
}
