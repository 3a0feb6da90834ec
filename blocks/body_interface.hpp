#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/graph/block.hpp>
#include <titop/graph/linalg/kinematics.hpp>
#include <vector>

/// Common to rigid and flexible bodies: ports, rigid direct terms and positions.
namespace titop {

/// Children in this order, then scalar channels of the shapes of lines, then "parent"; states eta1
/// ... etaN, then their rates. Throws duplicate_name.
Interface body_interface(const std::vector<std::string>& children, int modes,
                         const std::vector<std::string>& shapes = {});

/// Direct terms of the body as if rigid, [Alazard 2015] eq. (14) with N = 0:
/// [[0, tau_CP], [tau_CP', -D_P]], children first; those of shapes are 0. PC: from P to each C [m].
Eigen::MatrixXd rigid_part(const std::vector<Vector3d>& PC, const Matrix6& D_P,
                           Eigen::Index shapes = 0);

/// x_C = tau_CP x_P + Phi_C eta for every child; Phi_C is 6 x N. x = phi eta for every shape, a row
/// of Phi.
Kinematics body_kinematics(const std::vector<Vector3d>& PC,
                           const std::vector<Eigen::MatrixXd>& Phi_C,
                           const Eigen::MatrixXd& Phi = {});

}  // namespace titop
