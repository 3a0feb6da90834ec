#include <set>

#include "loops/frames.hpp"
#include "support/rng.hpp"

namespace loops_test {

using titop_test::Rng;

namespace {

/// Makes one; all joints of a plane one are in one plane, and their axes in it or across it.
struct FrameMaker {
  Rng rng;
  bool plane;
  Matrix3d world = rng.rotation();
  int names = 0;
  std::set<int> driven = {};  ///< beams whose end a weld or the ground drives
  Frame f = {};

  Vector3d point() {
    Vector3d p = rng.matrix(3, 1) * 2;
    if (plane) p(2) = 0.4;
    return world * p;
  }
  Vector3d direction() { return plane ? Vector3d(world.col(2)) : Vector3d(rng.rotation().col(2)); }
  Vector3d across() {
    if (!plane) return direction();
    Vector3d r = rng.matrix(3, 1);
    r(2) = 0;
    return world * r;
  }
  std::vector<titop::Axis> axes(bool may_weld) {
    using namespace titop;
    const Vector3d r = direction();
    switch (rng.below(plane ? 5 : 8)) {
      case 0:
        if (may_weld) return {};
        [[fallthrough]];
      case 1:
      case 2: return {about(r)};
      case 3: return {along(across())};
      case 4: return plane ? std::vector{about(r), along(across())} : cylindrical(r);
      case 5: return ball();
      case 6: return universal(r, direction());
      default: return titop::planar(r);
    }
  }
  /// In no order.
  std::string name(const char* kind) {
    return kind + std::to_string(rng.below(1000)) + "_" + std::to_string(names++);
  }

  void join(int a, int b, const Vector3d& X, bool closes, bool may_weld = true) {
    using Mode = Frame::JointAxis::Mode;
    Frame::Joint j{a, b, closes, X, {}, name("j")};
    for (const titop::Axis& axis : axes(may_weld)) {
      const int mode = rng.below(10);
      j.axes.push_back({axis, rng.between(20, 200),
                        mode < 7   ? Mode::sprung
                        : mode < 8 ? Mode::locked
                                   : Mode::free});
    }
    f.joints.push_back(j);
  }
  void add_body() {
    const auto i = static_cast<int>(f.bodies.size());
    Frame::Body body{rng.rotation(), Vector3d::Zero(), Vector3d::Zero(),
                     0.3 * Vector3d(rng.matrix(3, 1))};
    body.mass = rng.between(1, 5);
    body.beam = i > 0 && rng.chance(0.3);
    const int b = i > 0 ? rng.below(i) : 0;
    body.P = i > 0 && f.bodies[at(b)].beam ? f.bodies[at(b)].E : point();
    do body.E = point();
    while ((body.E - body.P).norm() < 0.3);
    if (body.beam) body.R = along_x(body.E - body.P, body.R);
    f.bodies.push_back(body);
    f.names.push_back(name("b"));
    if (i > 0) join(i, b, body.P, false);
  }
  /// Beams are held by their ends: two of them do not meet, and one end is driven by one weld.
  void close() {
    const int a = rng.below(static_cast<int>(f.bodies.size()));
    const int b = rng.below(static_cast<int>(f.bodies.size()) + 1) - 1;
    const bool beam_a = f.bodies[at(a)].beam, beam_b = b >= 0 && f.bodies[at(b)].beam;
    if (a == b || (beam_a && beam_b)) return;
    const bool may_weld = !beam_a || driven.insert(a).second;
    join(a, b, beam_a ? f.bodies[at(a)].E : beam_b ? f.bodies[at(b)].E : point(), true, may_weld);
  }

  void add_spring_mass() {
    f.spring_masses.push_back({rng.below(static_cast<int>(f.bodies.size())), rng.rotation().col(0),
                               rng.between(0.5, 2), rng.between(20, 200), name("m")});
  }
  void add_bushing() {
    const int a = rng.below(static_cast<int>(f.bodies.size()));
    const int b = rng.below(static_cast<int>(f.bodies.size()) + 1) - 1;
    const bool beam_a = f.bodies[at(a)].beam, beam_b = b >= 0 && f.bodies[at(b)].beam;
    if (a == b || (beam_a && beam_b)) return;
    const Vector3d X = beam_a ? f.bodies[at(a)].E : beam_b ? f.bodies[at(b)].E : point();
    by_hand::Matrix6 K = by_hand::Matrix6::Zero();
    for (Index i = 0; i < 6; ++i) K(i, i) = rng.between(20, 200);
    f.bushings.push_back({a, b, X, K, name("k")});
  }

  Frame make(bool springs) {
    const int count = 2 + rng.below(6), closings = 1 + rng.below(5);
    f.grounded = rng.chance(0.2);
    for (int i = 0; i < count; ++i) add_body();
    for (int i = 0; i < closings; ++i) close();
    f.pushed = rng.below(count), f.watched = rng.below(count);
    if (!springs) return f;
    for (int i = rng.below(3); i > 0; --i) add_spring_mass();
    for (int i = rng.below(3); i > 0; --i) add_bushing();
    return f;
  }
};

}  // namespace

Frame random_frame(int seed, bool plane, bool springs) {
  return FrameMaker{Rng(static_cast<std::uint64_t>(seed)), plane}.make(springs);
}

}  // namespace loops_test
