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

/// Clamped-free modal data of a flexible body, mass-normalised: [Alazard 2015] eqs (9) to (14).
/// N modes of the body clamped at its parent point P. N = 0 is a rigid body. All in the body's
/// frame, SI units. `FlexibleBody{data}` checks it and makes it a block.
struct ModalData {
  Eigen::VectorXd omega;             ///< N, natural frequencies [rad/s], > 0
  Eigen::VectorXd xi;                ///< N, damping ratios [-], >= 0, of the modes clamped at P;
                                     ///< those of an assembly differ: see damping_of_assembly
  Eigen::MatrixXd L_P;               ///< N x 6, participation factors at P [sqrt(kg), sqrt(kg) m]
  Matrix6 D_P = Matrix6::Zero();     ///< rigid mass matrix about P [kg, kg m, kg m^2]
  std::vector<ModalChild> children;  ///< the child points, none for an appendage
  double digits = 15;                ///< decimal digits that the data carry, > 0
};

}  // namespace titop
