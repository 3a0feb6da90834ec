#pragma once

#include <titop/blocks/fe/modal_data.hpp>

/// Checks of modal data before they become a body. For the folder's own files.
namespace titop::detail {

/// Of the modes of one body.
struct ModalParameters {
  Eigen::VectorXd omega, xi;  ///< N each, [rad/s] and [-]
};

/// Throws not_finite or bad_modes with the first mode that has no omega > 0 or no xi >= 0.
void check_modes(const ModalParameters& modes);

/// Throws size unless Z is n x n, not_finite, bad_modes unless it is symmetric and semidefinite, to
/// 1e-9 of its diagonal. O(n^3).
void check_damping(const Eigen::MatrixXd& Z, Eigen::Index n);

/// Throws bad_modes for shapes that do not fit, damping in percent, or modes that carry more mass
/// than there is; not_finite or bad_value for an entry that is none; bad_inertia for a D_P that is
/// no mass matrix of a rigid body about P. O(entries), and an eigenproblem of 6 x 6.
void check_modal_data(const ModalData& data);

}  // namespace titop::detail
