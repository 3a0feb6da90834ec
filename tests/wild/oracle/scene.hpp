#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

/// A scene as plain data, before any equations: the generator makes it, the oracle (oracle.hpp)
/// reads it as M, D, K and constraints, the writer (parts/write.hpp) as a diagram. Nothing in this
/// folder includes a header of the library.
namespace wild {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A point of a node: its parent point (site -1), or one of its sites. Node -1: the ground.
struct Point {
  int node = -1, site = -1;
  bool operator==(const Point&) const = default;
};

struct Axis {
  bool turns = false;
  Vector3d r = Vector3d::UnitX();  ///< a unit vector
};

/// A signal that can be read.
struct Reading {
  enum class Measured {
    input,          ///< number `axis`, all of it
    accel,          ///< of point `at`
    rate,           ///< of point `at`
    position,       ///< of point `at`
    reaction,       ///< of point `at`: the wrench of its ties
    axis_accel,     ///< of axis `axis` of the joint at.node
    axis_rate,      ///< likewise
    axis_position,  ///< likewise
    axis_force,     ///< likewise
    stretch,        ///< of the spring-mass at.node
    out,            ///< of the controller at.node
    displacement,   ///< of the bushing at.node, child against parent
    displacement_rate
  };
  Measured measured = Measured::input;
  Point at = {};
  int axis = 0;
  int half = 0;  ///< of six: 0 all, 1 the linear, 2 the angular three
};

/// Sum of gain * signal.
struct Share {
  Reading of;
  MatrixXd gain;
};
using Sum = std::vector<Share>;

struct Site {
  Vector3d PC = Vector3d::Zero();
  MatrixXd Phi;  ///< 6 x modes
};

/// A uniform beam along x of its frame, of elements + 1 points.
struct Beam {
  double length = 1, area = 1, I_y = 1, I_z = 1, J = 1;
  double I_x = 0;  ///< 0: I_y + I_z
  double E = 1, rho = 1, nu = 0.3;
  double G = 0;  ///< 0: by nu
  int elements = 1;
  int kept = -1;              ///< lowest modes clamped at the parent; -1: all
  std::vector<int> residual;  ///< points with residual vectors, if not all are kept
  std::vector<double> xi;     ///< none, one for all, or one per mode kept
  int parent = 0;             ///< a point
  std::vector<int> sites;     ///< the point of each site of the node
};

struct Node {
  enum class Kind { mass, body, joint, lti, bushing };
  Kind kind = Kind::body;
  std::string name = {};

  double m = 1, k = 1, c = 0, m0 = 0;  ///< mass: a spring-mass, its site 0 is on m

  double mass = 1;  ///< body
  Matrix3d inertia = Matrix3d::Identity();
  Vector3d PA = Vector3d::Zero();
  VectorXd omega, xi;        ///< no modes: a rigid body of these mass, inertia, PA
  MatrixXd L_P;              ///< modes x 6
  Matrix6d D_P;              ///< of a body with modes
  std::vector<Site> sites;   ///< body
  std::optional<Beam> beam;  ///< instead of mass ... D_P; sites have no Phi

  std::vector<Axis> axes;  ///< joint: its site 0 is where the body is mounted

  Matrix6d stiffness, damping;  ///< bushing: its site 0 is its child end, which has its frame

  MatrixXd A, B, C, D;  ///< lti
  enum class Written { lti, gain, matrix, sum };
  Written written = Written::lti;  ///< the block it is; of no states if none of the first
  Sum in;                          ///< lti
};

/// Point a moves as b does (b of the ground: does not move, or by an input), along some axes of a's
/// frame, and the wrench acts back.
struct Tie {
  enum class Of { all, linear, angular, axes };
  Point a, b;
  Matrix3d T = Matrix3d::Identity();  ///< a's components to b's
  Of of = Of::all;
  std::vector<Axis> axes = {};  ///< of Of::axes
  int input = -1;               ///< b the ground: the acceleration, one entry per axis
};

/// Law of an axis of a joint: force = k q + c qd + more, or acceleration = more.
struct Mechanism {
  int node = 0, axis = 0;
  bool moves = false;
  double k = 0, c = 0;
  Sum more = {};
};

/// A wrench on the body at a point.
struct Load {
  Point at;
  int half = 0;
  Sum sum;
};

struct Scene {
  std::vector<Node> nodes;
  std::vector<Tie> ties;
  std::vector<Mechanism> mechanisms;
  std::vector<Load> loads;
  std::vector<int> inputs;  ///< sizes
  std::vector<Reading> outputs;
  double omega = 1;  ///< a frequency that is typical of it [rad/s]
};

bool one_axis(const Scene& scene, const Point& point);
int size_of(const Scene& scene, const Reading& reading);
int size_of(const Scene& scene, const Tie& tie);
/// Rows of the tied axes in a's frame, (linear; angular): size x 6, or 1 x 1 of one axis.
MatrixXd rows_of(const Scene& scene, const Tie& tie);

/// True if any chain closes, through the ground too.
bool closes(const Scene& scene);

/// Sizes of the blocks in which a transfer is judged: at most three each.
std::vector<int> output_blocks(const Scene& scene);
std::vector<int> input_blocks(const Scene& scene);

}  // namespace wild
