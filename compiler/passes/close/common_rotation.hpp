#pragma once

#include <optional>
#include <titop/graph/linalg/kinematics.hpp>

namespace titop::passes::closing {

/// The rotation Q with S diag(Q, Q) = c (both rows x 6, the rows of S orthonormal): what ties to
/// one point say of how it is turned. Where they leave Q open, one of those that they allow: the
/// smallest if they tie one direction only. None if no rotation does that (a gear, a mirror, a
/// lever arm).
std::optional<Matrix3d> common_rotation(const Eigen::MatrixXd& S, const Eigen::MatrixXd& c);

}  // namespace titop::passes::closing
