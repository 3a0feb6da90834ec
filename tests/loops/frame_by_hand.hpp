#pragma once

#include "frames.hpp"

namespace loops_test {

/// A frame (frames.hpp) by M, D and K of all separate bodies, with the constraint rows of the
/// joints: rigid bodies have six coordinates, beams twelve, in their frames. Of the library only
/// the list of a joint's axes is used.
struct FrameByHand {
  explicit FrameByHand(const Frame& frame);

  const Frame& f;
  Assembly all;
  std::vector<Index> first;  ///< of each body's coordinates
  MatrixXd held;             ///< the constraint matrix: rows that are 0
  /// Rows of one joint: its part of `held`, and the stretches of its springs.
  struct JointRows {
    Index first = 0, count = 0;
    MatrixXd stretch;
    VectorXd stiffness;
  };
  std::vector<JointRows> joints;

 private:
  void hold(const MatrixXd& rows);
  /// Motion of body i at X in its frame (6 x n).
  MatrixXd at_point(int i, const Vector3d& X, bool end) const;
  MatrixXd in_world(int i, const Vector3d& X, bool end) const;
  void add(const Frame::SpringMass& m, Index own);
  void add(const Frame::Bushing& k);
  void spring(const MatrixXd& K, const MatrixXd& stretch);
  /// A spring of the present joint.
  void joint_spring(double stiffness, const MatrixXd& row);
  void join(const Frame::Joint& j);
};

}  // namespace loops_test
