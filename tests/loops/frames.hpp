#pragma once

#include <algorithm>
#include <set>
#include <titop/graph/linalg/eigen.hpp>

#include "assembly.hpp"
#include "support/rng.hpp"

/// Random frames: bodies that hang on each other through joints of all kinds, in space or in a
/// plane, and further joints that close chains through them, on other bodies or on the ground, so
/// that most bodies belong to several loops; as a diagram, and by M, D and K of all bodies by
/// themselves with the rows that the joints hold.

namespace loop_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using titop_test::Rng;

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

inline constexpr int kGround = -1;
inline constexpr double kDamping = 0.01;  ///< of every sprung axis: c / k [s]

/// A rigid body, or a beam from P to E along its x axis.
struct Part {
  Matrix3d R;  ///< its frame, to the world's
  Vector3d P, E, PA;
  bool beam = false;
  double mass = 1;

  Vector3d here(const Vector3d& X) const { return R.transpose() * (X - P); }
  Matrix3d inertia() const { return mass * Vector3d(0.2, 0.3, 0.4).asDiagonal(); }
  Tube tube() const { return {(E - P).norm(), 0.05, 0.04, 1}; }
};

/// One axis of a joint, in the world's frame.
struct Move {
  enum class Mode { sprung, locked, free };
  titop::Axis axis;
  double stiffness = 0;
  Mode mode = Mode::sprung;
};

/// Between a point of body a and one of body b, both at X. What hangs is a, by its P, unless the
/// joint closes a chain.
struct Joined {
  int a = 0, b = 0;
  bool closes = false;
  Vector3d X;
  std::vector<Move> moves;
  std::string name;
};

/// A mass on a spring along one direction (world's frame), at the end of a part.
struct Hung {
  int part = 0;
  Vector3d way;
  double mass = 1, stiffness = 1;
  std::string name;
};

/// A bushing between points of two bodies (b may be the ground), both at X, in the frame of a.
struct Cushion {
  int a = 0, b = 0;
  Vector3d X;
  by_hand::Matrix6 K;
  std::string name;
};

struct Frame {
  std::vector<Part> parts;  ///< the first is free, or on the ground
  std::vector<std::string> names;
  std::vector<Joined> joints;
  std::vector<Hung> hung = {};
  std::vector<Cushion> cushions = {};
  bool grounded = false;
  int pushed = 0, watched = 0;  ///< parts, at their last point
  bool on_ground() const {
    const auto held = [](const auto& j) { return j.b == kGround; };
    return grounded || std::any_of(joints.begin(), joints.end(), held) ||
           std::any_of(cushions.begin(), cushions.end(), held);
  }
};

/// Makes one; all joints of a plane one are in one plane, and their axes in it or across it.
struct Maker {
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
    Joined j{a, b, closes, X, {}, name("j")};
    for (const titop::Axis& axis : axes(may_weld)) {
      const int mode = rng.below(10);
      j.moves.push_back({axis, rng.between(20, 200),
                         mode < 7   ? Move::Mode::sprung
                         : mode < 8 ? Move::Mode::locked
                                    : Move::Mode::free});
    }
    f.joints.push_back(j);
  }
  void add_part() {
    const auto i = static_cast<int>(f.parts.size());
    Part p{rng.rotation(), Vector3d::Zero(), Vector3d::Zero(), 0.3 * Vector3d(rng.matrix(3, 1))};
    p.mass = rng.between(1, 5);
    p.beam = i > 0 && rng.chance(0.3);
    const int b = i > 0 ? rng.below(i) : 0;
    p.P = i > 0 && f.parts[at(b)].beam ? f.parts[at(b)].E : point();
    do p.E = point();
    while ((p.E - p.P).norm() < 0.3);
    if (p.beam) p.R = along_x(p.E - p.P, p.R);
    f.parts.push_back(p);
    f.names.push_back(name("b"));
    if (i > 0) join(i, b, p.P, false);
  }
  /// Beams are held by their ends: two of them do not meet, and what drives one end is one weld.
  void close() {
    const int a = rng.below(static_cast<int>(f.parts.size()));
    const int b = rng.below(static_cast<int>(f.parts.size()) + 1) - 1;
    const bool beam_a = f.parts[at(a)].beam, beam_b = b >= 0 && f.parts[at(b)].beam;
    if (a == b || (beam_a && beam_b)) return;
    const bool may_weld = !beam_a || driven.insert(a).second;
    join(a, b, beam_a ? f.parts[at(a)].E : beam_b ? f.parts[at(b)].E : point(), true, may_weld);
  }

  void hang_mass() {
    f.hung.push_back({rng.below(static_cast<int>(f.parts.size())), rng.rotation().col(0),
                      rng.between(0.5, 2), rng.between(20, 200), name("m")});
  }
  void cushion() {
    const int a = rng.below(static_cast<int>(f.parts.size()));
    const int b = rng.below(static_cast<int>(f.parts.size()) + 1) - 1;
    const bool beam_a = f.parts[at(a)].beam, beam_b = b >= 0 && f.parts[at(b)].beam;
    if (a == b || (beam_a && beam_b)) return;
    const Vector3d X = beam_a ? f.parts[at(a)].E : beam_b ? f.parts[at(b)].E : point();
    by_hand::Matrix6 K = by_hand::Matrix6::Zero();
    for (Index i = 0; i < 6; ++i) K(i, i) = rng.between(20, 200);
    f.cushions.push_back({a, b, X, K, name("k")});
  }

  /// The same frames whether masses and bushings are added or not.
  Frame make(bool springs) {
    const int count = 2 + rng.below(6), closings = 1 + rng.below(5);
    f.grounded = rng.chance(0.2);
    for (int i = 0; i < count; ++i) add_part();
    for (int i = 0; i < closings; ++i) close();
    f.pushed = rng.below(count), f.watched = rng.below(count);
    if (!springs) return f;
    for (int i = rng.below(3); i > 0; --i) hang_mass();
    for (int i = rng.below(3); i > 0; --i) cushion();
    return f;
  }
};

/// The axes in another frame, each with a name.
inline std::vector<titop::Axis> axes_of(const Joined& j, const Matrix3d& to) {
  std::vector<titop::Axis> result;
  for (const Move& m : j.moves)
    result.push_back({m.axis.kind, to * m.axis.direction, "q" + std::to_string(result.size())});
  return result;
}

struct Scene {
  const Frame& f;
  int read = -1;  ///< a joint that hangs a body: the wrench there of the body on what it hangs on
  bool driven = false;  ///< the first body moves as input A says
  titop::Diagram d{"frame"};
  std::vector<titop::BodyHandle> bodies = {};

  titop::BodyHandle add(int i) {
    const Part& p = f.parts[at(i)];
    if (p.beam) return d.add(f.names[at(i)], titop::FlexibleBody{p.tube().beam()});
    titop::RigidBody body{.mass = p.mass, .inertia = p.inertia(), .PA = p.PA};
    for (const Joined& j : f.joints) {
      if (j.b == i) body.children.push_back({"b" + j.name, p.here(j.X)});
      if (j.a == i && j.closes) body.children.push_back({"a" + j.name, p.here(j.X)});
    }
    for (const Cushion& c : f.cushions)
      if (c.a == i || c.b == i) body.children.push_back({c.name, p.here(c.X)});
    body.children.push_back({"E", p.here(p.E)});
    return d.add(f.names[at(i)], body);
  }
  titop::DualPort<6> point(int i, const std::string& name) const {
    return f.parts[at(i)].beam ? titop::DualPort<6>(bodies[at(i)].child)
                               : bodies[at(i)].child(name);
  }

  void move(const titop::Joint::Handle& h, const Joined& j) const {
    int number = 0;
    for (const Move& m : j.moves) {
      const auto q = h.axis("q" + std::to_string(number++));
      if (m.mode == Move::Mode::locked)
        q.accel = 0;
      else if (m.mode == Move::Mode::free)
        q.force = 0;
      else
        q.force = m.stiffness * q.position + kDamping * m.stiffness * q.rate;
    }
  }
  titop::Rotation between(int a, int b) const {
    const Matrix3d to_b = b == kGround ? Matrix3d::Identity() : Matrix3d(f.parts[at(b)].R);
    return titop::Rotation::matrix(to_b.transpose() * f.parts[at(a)].R);
  }
  void hang(const Joined& j) {
    const titop::DualPort<6> site = point(j.b, "b" + j.name);
    const titop::BodyHandle& body = bodies[at(j.a)];
    if (j.moves.empty()) return mount(body, site, between(j.a, j.b));
    move(
        joint(d, j.name, body, site, between(j.a, j.b), axes_of(j, f.parts[at(j.a)].R.transpose())),
        j);
  }
  /// The joint has the frame of b, or the world's.
  void close(const Joined& j) {
    const titop::DualPort<6> on_a = point(j.a, "a" + j.name);
    const bool to_ground = j.b == kGround;
    if (j.moves.empty())
      return to_ground ? ground(on_a) : weld(on_a, point(j.b, "b" + j.name), between(j.a, j.b));
    const Matrix3d R = to_ground ? Matrix3d::Identity() : Matrix3d(f.parts[at(j.b)].R);
    const auto h = d.add(j.name, titop::Joint{axes_of(j, R.transpose())});
    mount(h, on_a, titop::Rotation::matrix(f.parts[at(j.a)].R.transpose() * R));
    move(h, j);
    to_ground ? ground(h.child) : weld(h.child, point(j.b, "b" + j.name));
  }

  void hang(const Hung& h) {
    const auto mass = d.add(
        h.name, titop::SpringMass{
                    .mass = h.mass, .stiffness = h.stiffness, .damping = kDamping * h.stiffness});
    mount(mass, point(h.part, "E").along(f.parts[at(h.part)].R.transpose() * h.way));
  }
  void add(const Cushion& c) {
    const auto h = d.add(c.name, titop::Bushing{.stiffness = c.K, .damping = kDamping * c.K});
    mount(h, point(c.a, c.name));
    c.b == kGround ? ground(h.child) : weld(h.child, point(c.b, c.name), between(c.a, c.b));
  }

  titop::Diagram build() {
    for (int i = 0; i < static_cast<int>(f.parts.size()); ++i) bodies.push_back(add(i));
    if (driven)
      bodies[0].parent.accel = d.input("A", 6);
    else
      f.grounded ? ground(bodies[0]) : release(bodies[0]);
    for (const Joined& j : f.joints) j.closes ? close(j) : hang(j);
    for (const Hung& h : f.hung) hang(h);
    for (const Cushion& c : f.cushions) add(c);
    const auto U = d.input("U", 6);
    point(f.pushed, "E").force += U;
    d.output("pushed", 6) = point(f.pushed, "E").accel;
    d.output("watched", 6) = point(f.watched, "E").accel;
    if (read >= 0) d.output("force", 6) = bodies[at(f.joints[at(read)].a)].parent.force;
    return std::move(d);
  }
};

/// All bodies by themselves: rigid ones with six coordinates, beams with twelve, in their frames.
struct ByHand {
  const Frame& f;
  Assembly all;
  std::vector<Index> first;
  MatrixXd held;  ///< rows that are 0
  /// Of every joint: its rows of `held`, and the coordinates of its springs.
  struct Parts {
    Index first = 0, count = 0;
    MatrixXd q;
    VectorXd stiffness;
  };
  std::vector<Parts> parts = {};

  static Index size(const Frame& f) {
    Index n = std::ssize(f.hung);
    for (const Part& p : f.parts) n += p.beam ? 12 : 6;
    return n;
  }
  explicit ByHand(const Frame& frame) : f(frame), all(size(f), 6, 12), held(0, size(f)) {
    Index n = 0;
    for (const Part& p : f.parts) {
      first.push_back(n);
      if (p.beam)
        all.beam(p.tube().numbers(), all.unit(n, 6), all.unit(n + 6, 6), n + 12);
      else
        all.add(mass_at_P(p.mass, p.inertia(), p.PA), MatrixXd::Zero(6, 6), all.unit(n, 6));
      n += p.beam ? 12 : 6;
    }
    if (f.grounded) hold(all.unit(0, 6));
    for (const Joined& j : f.joints) {
      parts.push_back({held.rows(), 0, MatrixXd(0, held.cols()), VectorXd(0)});
      join(j);
      parts.back().count = held.rows() - parts.back().first;
    }
    for (const Hung& h : f.hung) hang(h, n++);
    for (const Cushion& c : f.cushions) add(c);
    const auto end = [&](int i) { return at_point(i, f.parts[at(i)].E, true); };
    all.a.C << end(f.pushed), end(f.watched);
    all.a.B = end(f.pushed).transpose();
  }

  void hold(const MatrixXd& rows) {
    held.conservativeResize(held.rows() + rows.rows(), held.cols());
    held.bottomRows(rows.rows()) = rows;
  }
  /// Motion of body i at X in its frame (6 x n).
  MatrixXd at_point(int i, const Vector3d& X, bool end) const {
    const Part& p = f.parts[at(i)];
    if (p.beam) return all.unit(first[at(i)] + (end ? 6 : 0), 6);
    return by_hand::tau(-p.here(X)) * all.unit(first[at(i)], 6);
  }
  MatrixXd in_world(int i, const Vector3d& X, bool end) const {
    if (i == kGround) return MatrixXd::Zero(6, held.cols());
    return by_hand::dual(f.parts[at(i)].R) * at_point(i, X, end);
  }
  void hang(const Hung& h, Index own) {
    const MatrixXd stretch = all.unit(own, 1);
    const MatrixXd way =
        h.way.transpose() * in_world(h.part, f.parts[at(h.part)].E, true).topRows(3) + stretch;
    all.a.M += h.mass * way.transpose() * way;
    spring(h.stiffness * MatrixXd::Identity(1, 1), stretch);
  }
  void add(const Cushion& c) {
    const MatrixXd apart = in_world(c.a, c.X, true) - in_world(c.b, c.X, true);
    spring(c.K, by_hand::dual(f.parts[at(c.a)].R).transpose() * apart);
  }
  void spring(const MatrixXd& K, const MatrixXd& q) {
    all.a.K += q.transpose() * K * q;
    all.a.D += kDamping * q.transpose() * K * q;
  }
  /// Of the present joint.
  void spring(double stiffness, const MatrixXd& row) {
    spring(stiffness * MatrixXd::Identity(1, 1), row);
    Parts& p = parts.back();
    p.q.conservativeResize(p.q.rows() + 1, held.cols());
    p.q.bottomRows(1) = row;
    p.stiffness.conservativeResize(p.q.rows());
    p.stiffness(p.q.rows() - 1) = stiffness;
  }
  void join(const Joined& j) {
    const MatrixXd apart = in_world(j.a, j.X, j.closes) - in_world(j.b, j.X, true);
    if (j.moves.empty()) return hold(apart);
    MatrixXd S(6, 0);
    for (const Move& m : j.moves) {
      S.conservativeResize(6, S.cols() + 1);
      S.rightCols(1) = titop::twist(m.axis);
    }
    const Eigen::JacobiSVD<MatrixXd> svd(S, Eigen::ComputeFullU | Eigen::ComputeFullV);
    hold(svd.matrixU().rightCols(6 - S.cols()).transpose() * apart);
    const MatrixXd q = svd.solve(apart);
    Index k = 0;
    for (const Move& m : j.moves) {
      const MatrixXd row = q.row(k++);
      if (m.mode == Move::Mode::locked) hold(row);
      if (m.mode == Move::Mode::sprung) spring(m.stiffness, row);
    }
  }
};

}  // namespace loop_test
