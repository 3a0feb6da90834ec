#pragma once

#include <optional>
#include <titop/graph/linalg/kinematics.hpp>

namespace titop::loops {

/// The rotation Q with S diag(Q, Q) = c (both rows x 6, the rows of S orthonormal): the orientation
/// by the ties to one point. If they do not determine Q, one of the possible ones: the smallest if
/// they tie one direction only. None if no rotation satisfies it (a gear, a mirror, a lever arm).
std::optional<Matrix3d> common_rotation(const Eigen::MatrixXd& S, const Eigen::MatrixXd& c);

}  // namespace titop::loops
