#pragma once

#include <optional>
#include <titop/blocks/axis.hpp>
#include <titop/graph/rotation.hpp>
#include <vector>

/// The posture of a mechanism: the angles and travels at which its links close a loop; they are the
/// mounting rotations of the scene's hinges, slides and mounts.
namespace titop {

/// A joint of a loop, and the link that follows it.
struct LoopStep {
  /// about(r) or along(r); r in the joint's frame: in the frame of the link before it is turn r,
  /// with the `turn` of that link, of the last link for the first joint.
  Axis joint;
  std::optional<double> given = {};  ///< its angle [rad] or travel [m], if it is known
  double guess = 0;                  ///< its start value otherwise
  Vector3d link = Vector3d::Zero();  ///< from this joint to the next one, in the link's frame [m]
  Rotation turn = {};                ///< next joint's frame to the link's frame (nominal values)
};

/// Result of `posture`; lists have one entry per joint, in the order of the loop.
struct Posture {
  std::vector<double> values;  ///< angle [rad] or travel [m]
  /// Mounting rotation: frame of the link after the joint to frame of the link before it, with the
  /// `turn` of that.
  std::vector<Rotation> T_ba;
  /// Translation in the joint, from the end of the link before it, in that link's frame [m]: the
  /// travel of a slide; 0 for a revolute joint.
  std::vector<Vector3d> offset;
  double gap = 0, gap_angle = 0;  ///< remaining misclosure [m], [rad]
};

/// Options of `posture`.
struct PostureOptions {
  /// A loop counts as closed with gaps up to this, of its size [-] and in [rad]: more than the
  /// digits of the data, if it is overconstrained.
  double tolerance = 1e-9;
};

/// Closes a loop, planar or spatial: finds the values that are not given so that joint, link,
/// joint, link ... ends where it began, in position and in orientation.
///
///     // four-bar: crank 0.3 m at 40 degrees, coupler, rocker, and the frame as the last link
///     const Vector3d z(0, 0, 1);
///     const Posture p = posture({{.joint = about(z), .given = 0.7, .link = {0.3, 0, 0}},
///                                {.joint = about(z), .guess = -0.5, .link = {0.9, 0, 0}},
///                                {.joint = about(z), .guess = -1, .link = {0.7, 0, 0}},
///                                {.joint = about(z), .link = {-1.0, 0, 0}}});
///     hinge(d, "B", coupler, crank.child, p.T_ba[1], z);
///
/// Levenberg-Marquardt on the pose of the end, from the guesses. Of several postures it returns the
/// one to which the guesses converge, angles within pi of them; if they do not converge, it tries
/// other starts, at increasing distance, always the same ones. O(iterations * joints^3): 50
/// microseconds for a four-bar from a fair guess, a hundred times that until kinematic_loop is
/// thrown.
///
/// Throws kinematic_loop if the loop cannot be closed (with the smallest gap), singular if it is
/// closed but can still move with the given values (which joints), bad_value for an empty loop or
/// an axis without direction, not_finite.
Posture posture(const std::vector<LoopStep>& loop, const PostureOptions& options = {});

}  // namespace titop
