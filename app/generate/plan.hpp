#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "generate/ratio.hpp"

/// A random scene as plain data, before it is written as a diagram file (scene.cpp) and as
/// equations of motion (assembly.hpp). Nothing of the library is used in either.
namespace titop::generate {

using Vec3 = std::array<Ratio, 3>;
using Mat3 = std::array<Vec3, 3>;                     ///< rows
using RatioMatrix = std::vector<std::vector<Ratio>>;  ///< a matrix

/// An item with a motion: a spring-mass's ends, a body's points, a joint's ends, by name.
struct PlannedPoint {
  int block = -1;
  std::string channel = {};  ///< "parent", "child", "C1", ...
};

/// Attachment of the parent point of a block.
struct Attachment {
  enum class Kind {
    mounted,  ///< on `on`, turned by T (body to site), or along one direction of it
    ground,   ///< held
    free,     ///< an input wrench acts, or nothing
    imposed,  ///< its acceleration is an input
    pinned    ///< held in translation
  };
  Kind kind = Kind::ground;
  PlannedPoint on = {};
  Mat3 T = {};
  bool turned = false;             ///< T is given
  std::optional<Vec3> along = {};  ///< a spring-mass on a body: unit vector
  std::string input = {};          ///< free: wrench; imposed: acceleration; "": none
};

struct Spring {
  Ratio mass, stiffness, damping, parent_mass;
};

struct BodyPoint {
  std::string name;
  Vec3 PC = {};
  RatioMatrix Phi = {};  ///< 6 x N
};
struct Body {
  Ratio mass;
  Vec3 inertia = {};  ///< principal, about the centre of mass
  Vec3 PA = {};
  std::vector<Ratio> omega = {}, xi = {};
  RatioMatrix L = {};  ///< N x 6
  std::vector<BodyPoint> points = {};
};

/// Hinge or slide; sprung, driven by an input force, or with a controller (then k = c = 0).
struct PlannedJoint {
  bool turns = true;
  Vec3 axis = {};  ///< unit vector
  Ratio stiffness = {}, damping = {};
  std::string input = {};
};

struct PlannedBlock {
  std::string name;
  Attachment base = {};
  std::optional<Spring> spring = {};
  std::optional<Body> body = {};
  std::optional<PlannedJoint> joint = {};
  std::string stiffness_parameter = {};  ///< of a spring-mass: the number has a name

  int size() const { return spring ? 1 : 6; }
};

/// A point's one direction: of a spring-mass's end, or `along` of a body's point.
struct ControlPoint {
  PlannedPoint point;
  std::optional<Vec3> along = {};
};

/// Controller of as many inputs as outputs: xdot = A x + B e, v = C x + D e.
struct Control {
  enum class Law {
    position,      ///< e: stretch or angle of `block`; v pulls it back
    acceleration,  ///< e: accelerations at `at`; v pushes against them there
    filter         ///< e: accelerations at `at`; v is read only
  };
  std::string name;
  Law law = Law::position;
  int block = -1;                     ///< position
  std::vector<ControlPoint> at = {};  ///< one per input; of a spring-mass's position its child
  RatioMatrix A = {}, B = {}, C = {}, D = {};

  std::size_t size() const { return D.size(); }
};

/// One closure in addition to the tree: `point` moves with `with` (turned by T), or is fixed.
struct Closure {
  PlannedPoint point;
  std::optional<PlannedPoint> with = {};
  Mat3 T = {};
};

/// Rows among a point's six: all, the linear ones, or one direction.
struct PlannedPart {
  enum class Kind { all, linear, along };
  Kind kind = Kind::all;
  Vec3 direction = {};
};

/// A force on a point, in addition to those of bases and joints.
struct Load {
  std::string input;
  PlannedPoint point;
  PlannedPart part = {};
  Ratio gain = 1;
};

struct PlannedReading {
  enum class Of { acceleration, position, relative, support, reaction, control };
  std::string output = {};
  Of of = Of::acceleration;
  PlannedPoint point = {};  ///< `relative`: block; `support`: its parent; `reaction`: held point;
                            ///< `control`: v of the one of this index
  PlannedPart part = {};
};

struct Named {
  std::string name;
  int size = 1;
};

struct ScenePlan {
  std::string name;
  std::vector<PlannedBlock> blocks;  ///< a block comes after the block on which it is mounted
  std::vector<Control> controls;
  std::vector<Closure> closures;
  std::vector<Load> loads;
  std::vector<PlannedReading> readings;
  std::vector<Named> inputs, outputs;
};

// --- three dimensions ----------------------------------------------------------------------------

inline Mat3 unit3() {
  Mat3 T{};
  for (std::size_t i = 0; i < 3; ++i) T[i][i] = 1;
  return T;
}
inline Mat3 transposed(const Mat3& T) {
  Mat3 U{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) U[j][i] = T[i][j];
  return U;
}
inline Vec3 operator*(const Mat3& T, const Vec3& v) {
  Vec3 w{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) w[i] = w[i] + T[i][j] * v[j];
  return w;
}
inline Mat3 operator*(const Mat3& A, const Mat3& B) {
  Mat3 C{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) C[i][j] = C[i][j] + A[i][k] * B[k][j];
  return C;
}
inline Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec3 operator-(const Vec3& a) { return {-a[0], -a[1], -a[2]}; }

/// Rows of the cross product with v: (*v) w = v x w.
inline Mat3 cross(const Vec3& v) {
  return {{{0, -v[2], v[1]}, {v[2], 0, -v[0]}, {-v[1], v[0], 0}}};
}

/// D_P = tau_AP' diag(m, I_A) tau_AP with AP = -PA: [m, m (*AP); m (*AP)', I_A - m (*AP)^2].
inline RatioMatrix rigid_mass(const Body& b) {
  const Mat3 x = cross(-b.PA), xx = transposed(x) * x;
  RatioMatrix D(6, std::vector<Ratio>(6));
  for (std::size_t i = 0; i < 3; ++i) {
    D[i][i] = b.mass;
    for (std::size_t j = 0; j < 3; ++j) {
      D[i][3 + j] = b.mass * x[i][j];
      D[3 + j][i] = D[i][3 + j];
      D[3 + i][3 + j] = b.mass * xx[i][j] + (i == j ? b.inertia[i] : Ratio(0));
    }
  }
  return D;
}

}  // namespace titop::generate
