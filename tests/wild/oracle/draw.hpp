#pragma once

#include "support/rng.hpp"
#include "wild/oracle/scene.hpp"

/// Random scenes, small, with many special cases. The same seed gives the same scene on every
/// machine and by every compiler: no expression draws twice, as operands and arguments have no
/// order.
namespace wild {

using titop_test::Rng;

Scene draw_row(Rng& rng);          ///< spring-masses on each other, lossless to very lossy
Scene draw_tree(Rng& rng);         ///< bodies with and without modes, joints
Scene draw_loop(Rng& rng);         ///< the same, closed
Scene draw_half_ties(Rng& rng);    ///< bodies tied along some axes only, at one to three places
Scene draw_controller(Rng& rng);   ///< Lti blocks of 3 to 12 states, alone and around mechanics
Scene draw_gains(Rng& rng);        ///< loops of numbers, alone and around mechanics
Scene draw_steep_gains(Rng& rng);  ///< the same with loop gains up to 1e-6 from 1
Scene draw_equal(Rng& rng);        ///< a hub with equal appendages at symmetric places
Scene draw_bushings(Rng& rng);     ///< bodies on springs and dampers of six axes
Scene draw_beams(Rng& rng);        ///< trees of bodies and finite-element beams, some closed

/// A scene in the making, with the pose of every node.
class Draft {
 public:
  explicit Draft(Rng& r) : rng(r) {}

  Rng& rng;
  Scene scene;

  int add(Node node, const Matrix3d& R = Matrix3d::Identity(),
          const Vector3d& p = Vector3d::Zero());
  /// In a frame of its own, turned against `frame`.
  int add_turned(Node node, const Matrix3d& frame, const Vector3d& p = Vector3d::Zero());
  /// Factor spread evenly over octaves.
  double factor(int low, int high) { return rng.octaves(low, high); }
  /// Entries between -1 and 1, times one factor.
  MatrixXd matrix(int low, int high, Eigen::Index rows, Eigen::Index cols);
  Vector3d unit();
  Matrix3d rotation();
  /// A body, rigid or with modes, hanging nowhere yet.
  Node body();
  /// A beam of 1 to 4 elements, all or some of its modes.
  Node beam();
  /// A new site of a body (one that a beam has) at a place of its own, or at a given global one.
  Point site(int node);
  Point site_at(int node, const Vector3d& global);
  Vector3d place(const Point& point) const;
  const Matrix3d& frame(int node) const { return R_[static_cast<std::size_t>(node)]; }
  /// Ties a to b along all axes.
  void mount(const Point& a, const Point& b);
  /// A joint at `b`, in a new frame; returns its node.
  int joint(const Point& b, const std::vector<Axis>& axes);
  /// A bushing in the frame `in`, or one of its own: its parent end at `b`, or on the ground, held
  /// or driven there.
  int bushing(const Point& b, const Vector3d& where, const Matrix3d* in = nullptr);
  std::vector<Axis> some_axes();
  void mechanism(int node, int axis);
  int input(int size);
  void load(const Point& at);
  void base(int node);
  /// `beams`: share of its bodies.
  void tree(int bodies, double beams = 0);
  void outputs(int count);
  Reading any_motion();
  Node controller(int states, int ins, int outs);
  /// out = D in, as a block that can be written so.
  Node gain(const MatrixXd& D);

 private:
  std::vector<Matrix3d> R_;
  std::vector<Vector3d> p_;
};

}  // namespace wild
