#pragma once

#include <Eigen/Core>
#include <vector>

/// Bushings whose axes are coupled by stiffness or damping, and bodies whose modes are coupled by
/// damping. For the folder's own files.
namespace titop::detail {

struct SystemData;

/// Coordinates of a bushing's axes, or a body's modes, with stiffness, and its matrices of these.
struct CoupledSpring {
  std::vector<int> list;
  Eigen::MatrixXd K, C;  ///< K positive definite
};

/// The bushings with such coordinates of which K or C is not diagonal, without those whose K is
/// singular on these axes; the bodies with a damping matrix. `coordinate`: per state of all blocks;
/// -1: none.
std::vector<CoupledSpring> coupled_springs(const SystemData& data,
                                           const std::vector<int>& coordinate);

}  // namespace titop::detail
