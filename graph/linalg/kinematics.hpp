#pragma once

#include <Eigen/Core>

/// Rigid kinematics of dual vectors (linear; angular). [Alazard 2015] nomenclature.
namespace titop {

// Eigen's own names, so that `using namespace Eigen` together with `using namespace titop` stays
// clear.
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// (*v), the cross-product matrix: cross(v) * w = v x w. [unit of v]
Matrix3d cross(const Vector3d& v);

/// Kinematic model tau_CP = [[I, (*CP)], [0, I]] (6 x 6); CP is the vector from C to P [m].
/// Accelerations of a rigid body: xdd_C = tau_CP xdd_P. Wrenches: F_P = tau_CP' F_C.
Matrix6 tau(const Vector3d& CP);

/// Mass matrix of a rigid body about P (6 x 6): tau_AP' diag(m I, I_A) tau_AP.
/// mass [kg]; I_A inertia about the centre of mass A [kg m^2]; AP vector from A to P [m].
Matrix6 rigid_mass(double mass, const Matrix3d& I_A, const Vector3d& AP);

}  // namespace titop
