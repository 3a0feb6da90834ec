#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/graph/block.hpp>
#include <titop/graph/linalg/kinematics.hpp>
#include <vector>

/// Common to rigid and flexible bodies: ports, rigid direct terms and positions.
namespace titop {

/// Children in this order, then "parent"; states eta1 ... etaN, then their rates. Throws
/// duplicate_name.
Interface body_interface(const std::vector<std::string>& children, int modes);

/// Direct terms of the body as if rigid, [Alazard 2015] eq. (14) with N = 0:
/// [[0, tau_CP], [tau_CP', -D_P]], children first. PC: from P to each C [m].
Eigen::MatrixXd rigid_part(const std::vector<Vector3d>& PC, const Matrix6& D_P);

/// x_C = tau_CP x_P + Phi_C eta for every child; Phi_C is 6 x N.
Kinematics body_kinematics(const std::vector<Vector3d>& PC,
                           const std::vector<Eigen::MatrixXd>& Phi_C);

}  // namespace titop
