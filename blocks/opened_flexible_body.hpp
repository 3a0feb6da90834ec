#pragma once

#include <titop/blocks/check_modal_data.hpp>
#include <titop/blocks/flexible_body.hpp>

namespace titop {

/// Block::opened of a flexible body of the modes `modes` and the input matrix W (N x inputs) at
/// these values, whose matrices are `dynamics`. With v = omega eta + 2 xi etad and etadd = W u -
/// omega v: omega has z = eta, whose w adds to v, and z = v, whose w subtracts from etadd; xi has z
/// = etad, whose w adds twice to v. An entry W_ij has z = u_j, whose w adds to etadd_i, and z =
/// etadd_i, whose w adds to y_j; one of a child moves the child's position by w = d eta_i too.
Opened opened_flexible_body(const FlexibleBody::Spec& spec, const detail::ModalParameters& modes,
                            const Eigen::MatrixXd& W, const Dynamics& dynamics,
                            std::span<const int> parameters);

}  // namespace titop
