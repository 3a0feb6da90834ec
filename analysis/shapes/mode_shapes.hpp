#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/linalg/kinematics.hpp>
#include <utility>
#include <vector>

/// Mode shapes: the motion of the structure's points in a mode.
namespace titop {

/// A port of a body or joint, in the posture of the diagram.
struct StructurePoint {
  std::string name;  ///< "wing.C1"
  /// Position relative to the first point of its assembly, in the frame of that point [m].
  Vector3d place = Vector3d::Zero();
};

/// Motion of all points in one mode: the real part of (motion * exp(s t)), small, in the frame of
/// the first point of each assembly. One column for each point.
struct ModeShape {
  int index = 0;  ///< of its pole in system.poles()
  Pole pole;
  Eigen::Matrix3Xcd translation;  ///< [m], the largest is 1 m
  Eigen::Matrix3Xcd rotation;     ///< [rad]
};

/// The points, and their motion in some modes.
struct ModeShapes {
  std::vector<StructurePoint> points;
  std::vector<std::pair<int, int>> lines;  ///< from a body's parent point to each of its children
  std::vector<ModeShape> modes;            ///< of the requested poles that have a shape
  std::vector<std::string> without;        ///< the others, with the reason
  std::vector<std::string> notes;          ///< blocks without positions, unknown distances
};

/// Shapes of modes, given by the indices of their poles in system.poles().
///
/// Points are the ports of six degrees of freedom of blocks with Block::kinematics, and ports of
/// one axis that are mounted on such a point (`mount(z, hub.child("C").along(r))`). Their places
/// follow from the ports of each body and from the equations between accelerations: joined points
/// coincide, turned as in the equations; the travel of a slide is not known and counts as 0.
/// Assemblies that are connected through the ground alone all begin at the origin; a note tells it.
///
/// A shape is the motion that the inputs of the diagram excite: the residue of the transfer from
/// the inputs to the accelerations of all points (without inputs: from forces at all points), its
/// largest singular vector. The shapes of n equal poles are the n largest singular vectors, which
/// depend on the units of the inputs. The phase is that of the largest sum of squared translations.
///
/// A pole at 0 has no shape, nor has a mode that moves no point or that no input excites.
///
/// Throws unknown_name for an index outside of poles(); bad_value for a diagram without points, and
/// if none of the poles has a shape; improper if the acceleration of a point without mass is no
/// proper function of the inputs. Cost: `compile`, poles(), and 16 transfers for each mode.
ModeShapes mode_shapes(const System& system, std::span<const int> poles);

}  // namespace titop
