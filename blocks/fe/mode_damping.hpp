#pragma once

#include <titop/blocks/fe/mesh.hpp>

/// Damping of the modes of a mesh. For the folder's own files.
namespace titop::fe {

/// Damping ratios by these options of modes of these frequencies, the first `kept` without residual
/// vectors. Throws bad_value, size.
Eigen::VectorXd damping_ratios(const Mesh& mesh, const ModeOptions& options, Eigen::Index kept,
                               const Eigen::VectorXd& omega);

}  // namespace titop::fe
