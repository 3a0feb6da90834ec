#pragma once

#include <algorithm>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>

#include "assembly.hpp"

/// Random frames: bodies mounted on each other through joints of all kinds, in space or in a plane,
/// and further joints that close chains through them, on other bodies or on the ground, so that
/// most bodies belong to several loops. Here the numbers alone; frame_diagram.hpp makes diagrams of
/// them, frame_by_hand.hpp M, D and K.

namespace loops_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using titop::linalg::at;

inline constexpr int kGround = -1;
inline constexpr double kDamping = 0.01;  ///< of every sprung axis: c / k [s]

struct Frame {
  /// A rigid body, or a beam from P to E along its x axis.
  struct Body {
    Matrix3d R;  ///< its frame, to the world's
    Vector3d P, E, PA;
    bool beam = false;
    double mass = 1;

    Vector3d here(const Vector3d& X) const { return R.transpose() * (X - P); }
    Matrix3d inertia() const { return mass * Vector3d(0.2, 0.3, 0.4).asDiagonal(); }
    Tube tube() const { return {(E - P).norm(), 0.05, 0.04, 1}; }
  };

  /// One degree of freedom of a joint, in the world's frame.
  struct JointAxis {
    enum class Mode { sprung, locked, free };
    titop::Axis axis;
    double stiffness = 0;
    Mode mode = Mode::sprung;
  };

  /// Between a point of body a and one of body b, both at X; a weld without axes. a is mounted on
  /// b, by its P, unless the joint closes a chain.
  struct Joint {
    int a = 0, b = 0;
    bool closes = false;
    Vector3d X;
    std::vector<JointAxis> axes;
    std::string name;
  };

  /// A mass on a spring along one direction (world's frame), at the end of a body.
  struct SpringMass {
    int body = 0;
    Vector3d direction;
    double mass = 1, stiffness = 1;
    std::string name;
  };

  /// Between points of two bodies (b may be the ground), both at X, in the frame of a.
  struct Bushing {
    int a = 0, b = 0;
    Vector3d X;
    by_hand::Matrix6 K;
    std::string name;
  };

  std::vector<Body> bodies;  ///< the first is free, or on the ground
  std::vector<std::string> names;
  std::vector<Joint> joints;
  std::vector<SpringMass> spring_masses = {};
  std::vector<Bushing> bushings = {};
  bool grounded = false;
  int pushed = 0, watched = 0;  ///< bodies, at their last point
  bool on_ground() const {
    const auto held = [](const auto& j) { return j.b == kGround; };
    return grounded || std::any_of(joints.begin(), joints.end(), held) ||
           std::any_of(bushings.begin(), bushings.end(), held);
  }
};

/// `springs`: also masses on springs and bushings; the same frame without them otherwise.
Frame random_frame(int seed, bool plane, bool springs);

}  // namespace loops_test
