#pragma once

#include <titop/graph/state_space.hpp>

/// Gramians, and the models whose H2 norm is finite. For the library's own files.
namespace titop::detail {

/// P of A P + P A' + B B' = 0, A stable: the controllability Gramian. O(30 n^3).
Eigen::MatrixXd gramian(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Throws singular, naming the pole, if one is not left of the axis, as far as rounding lets it be
/// known. `scaled`: by detail::scaled.
void require_stable_h2(const StateSpace& scaled);

/// Throws singular: a direct term.
[[noreturn]] void refuse_direct_h2();

}  // namespace titop::detail
