#pragma once

// Rigid and flexible bodies, tied by any of the six directions of their points, in turned frames:
// as a diagram, and in maximal coordinates (all bodies' motions and modes, and one row for every
// direction that is tied), which shares nothing with the library but the numbers.

#include <Eigen/Geometry>
#include <algorithm>
#include <complex>
#include <optional>
#include <string>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>
#include <vector>

#include "rng.hpp"

namespace half_ties {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using titop_test::Rng;

/// Rotor at a point of a body, balanced about an axis in the body's frame.
struct Spinning {
  double mass = 1, axial = 1, transverse = 1, friction = 0;
  bool held = false;                   ///< at its speed; otherwise friction alone brakes it
  Vector3d centre = Vector3d::Zero();  ///< of mass, from the point
};

/// Angular momentum of a body at a point, about an axis in the body's frame: of a rotor there, or
/// of one whose mass is in that of the body. Point -1: the parent.
struct Momentum {
  int point = -1;
  double h = 0;
  Vector3d axis = Vector3d::UnitZ();
  std::optional<Spinning> rotor = {};
};

/// At its place in the world: components of its frame to those of the world, parent point.
struct Body {
  Matrix3d turn = Matrix3d::Identity();
  Vector3d place = Vector3d::Zero();
  titop::Matrix6 D_P = titop::Matrix6::Zero();
  double mass = 1;
  Matrix3d inertia = Matrix3d::Identity();
  Vector3d PA = Vector3d::Zero();
  VectorXd omega = {};
  MatrixXd L_P = {};
  std::vector<titop::ModalChild> points = {};
  std::vector<Momentum> momenta = {};

  Index modes() const { return omega.size(); }
};

/// The directions of `mask` (three translations, three rotations, in the target's frame) of a
/// target's point are those of a source's. Point -1: the parent; source -1: the ground.
struct HalfTie {
  int target = 0, target_point = -1, source = -1, source_point = -1, mask = 63;
  bool by_halves = false;  ///< three directions are one equation
  bool slide = false;      ///< written as a joint: all directions but one translation

  bool ties(int direction) const { return (mask >> direction & 1) != 0; }
};

struct Sketch {
  std::vector<Body> bodies;
  std::vector<HalfTie> ties;
  int load = 0, load_point = 0, seen = 0, seen_point = 0;
};

inline const Body& body(const Sketch& s, int i) { return s.bodies[static_cast<std::size_t>(i)]; }
inline Body& body(Sketch& s, int i) { return s.bodies[static_cast<std::size_t>(i)]; }

/// Components of the source's frame to those of the target's.
inline Matrix3d turn(const Sketch& s, const HalfTie& t) {
  return body(s, t.target).turn.transpose() * body(s, t.source).turn;
}

/// A tree of two to five bodies, closed once or twice; ties of any directions at any place. With
/// `slides` half of the tree's ties are those of slides.
Sketch draw(Rng& rng, bool flexible, bool slides = false);
/// These directions in place of the tie's own, at one place.
void tie_again(Sketch& sketch, HalfTie& tie, int mask);
/// A momentum of up to `size` at the parent or at a point of every other body, and of the first;
/// half of those at points are of rotors.
void draw_momenta(Rng& rng, Sketch& sketch, double size);
/// The same with all momenta reversed.
Sketch reversed(Sketch sketch);
/// Output: the rate of a point, six; input: a wrench on another.
titop::Diagram diagram(const Sketch& sketch);

/// All motions that the ties allow, by an orthonormal basis.
struct Oracle {
  MatrixXd M, G, K, B, C;
  double gap = 1;  ///< smallest singular value of the ties that counts, over the largest

  MatrixXcd rate(std::complex<double> s) const {
    const MatrixXcd Z = s * s * M + s * G + K;
    return s * (C * Z.partialPivLu().solve(MatrixXcd(B.cast<std::complex<double>>())));
  }
};
Oracle oracle(const Sketch& sketch);

/// A body that turns with another and is held beside it: half of its motion is tied at either end,
/// and its rates follow from the other body's. A torque about z; the rate of the second body.
inline titop::Diagram turned() {
  using namespace titop;
  const Rotation I = Rotation::about({0, 0, 1}, 0.0);
  Diagram d{"turned"};
  auto T = d.input("T");
  auto a = d.add("a", RigidBody{.children = {{"e", {1, 0, 0}}, {"k", {0, 1, 0}}}});
  auto b = d.add("b", RigidBody{.children = {{"k", {0, 0, 0}}}});
  a.parent.accel.linear = 0;
  release(a);
  b.parent.accel.angular = I * a.child("e").accel.angular;
  a.child("e").force.angular += I * b.parent.reaction.angular();
  release(b);
  weld(b.child("k"), a.child("k"), I);
  b.child("k").force.angular.along({0, 0, 1}) += T;
  d.output("rate", 6) = b.parent.rate;
  return d;
}

}  // namespace half_ties
