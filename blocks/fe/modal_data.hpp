#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/graph/linalg/kinematics.hpp>
#include <vector>

namespace titop {

/// A child point of a flexible body, with its motion by the modes.
struct ModalChild {
  std::string name;
  Vector3d PC = Vector3d::Zero();  ///< vector from P to C in the body's frame [m]
  Eigen::MatrixXd Phi_C;  ///< 6 x N: the modes' displacements at C [1/sqrt(kg)], below them their
                          ///< rotations [rad/(m sqrt(kg))]
};

/// A shape of a line: the Legendre polynomial of this degree along it, from -1 at its start to 1 at
/// its end, as displacement along a body axis (component 0, 1, 2) or as rotation about the line
/// (3, 4, 5).
struct LineShape {
  int component = 0;
  int degree = 0;
};

/// "z2", "ry1".
std::string to_string(const LineShape& shape);

/// An edge as an interface (`fe::shapes`, `fe::moments`): its motion beyond the rigid one of the
/// child or parent of this name, which is at its middle. Every shape is a scalar channel of the
/// body, "C.z2": the acceleration of its coordinate and the force that belongs to it. Shapes that
/// no equation drives are free, also those of the parent: `ground(panel)` fixes its middle alone,
/// `ground(panel.line("root"))` the whole line.
struct ModalLine {
  std::string name;               ///< of the child, or of the parent's interface in the mesh
  int axis = 0;                   ///< body axis along which it runs: 0, 1, 2
  double length = 0;              ///< [m]
  std::vector<LineShape> shapes;  ///< at least one
  Eigen::MatrixXd
      Phi;  ///< shapes x N: their coordinates in the modes [1/sqrt(kg), rad/(m sqrt(kg))]
};

/// Clamped-free modal data of a flexible body, mass-normalised: [Alazard 2015] eqs (9) to (14).
/// N modes of the body clamped at its parent point P. N = 0 is a rigid body. All in the body's
/// frame, SI units. `FlexibleBody{data}` checks it and makes it a block.
struct ModalData {
  Eigen::VectorXd omega;              ///< N, natural frequencies [rad/s], > 0
  Eigen::VectorXd xi;                 ///< N, damping ratios [-], >= 0, of the modes clamped at P;
                                      ///< those of an assembly differ: see damping_of_assembly
  Eigen::MatrixXd L_P;                ///< N x 6, participation factors at P [sqrt(kg), sqrt(kg) m]
  Matrix6 D_P = Matrix6::Zero();      ///< rigid mass matrix about P [kg, kg m, kg m^2]
  std::vector<ModalChild> children;   ///< the child points, none for an appendage
  double digits = 15;                 ///< decimal digits that the data carry, > 0
  std::vector<ModalLine> lines = {};  ///< of children and of the parent, if they are edges
  std::vector<std::string> warnings =
      {};  ///< for the log of `compile`; diagram files leave them out
};

}  // namespace titop
