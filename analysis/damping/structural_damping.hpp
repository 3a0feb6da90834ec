#pragma once

#include <Eigen/Core>
#include <span>
#include <titop/graph/diagram.hpp>
#include <vector>

namespace titop {

/// Transfers at s = j omega (outputs x inputs), for each omega [rad/s], of a diagram in which
/// bodies have loss factors (FlexibleBody::with_loss_factor), which `compile` refuses. At each
/// omega the stiffness (1 + j eta) K is that with viscous damping eta K / omega: one `update` and
/// one transfer of a system whose damping ratios are a parameter. At omega = 0 the stiffness is
/// real; at -omega the transfer is the conjugate. Without loss factors these are the transfers of
/// `compile`.
///
/// Structural damping is not causal (its impulse response begins before the impulse): use it for
/// harmonic motion only. Parameters are at their nominal values; on `threads` threads (0: all
/// cores), the same to the last bit for any number. Throws the errors of `compile` and
/// `System::transfer`. Cost: a compile, and per omega an update of the bodies with loss factors,
/// O(N^2) each.
///
///     auto wing = d.add("wing", FlexibleBody{beam}.with_loss_factor(0.02));
///     const auto H = frequency_response(d, omega);
std::vector<Eigen::MatrixXcd> frequency_response(const Diagram& diagram,
                                                 std::span<const double> omega, int threads = 0);

}  // namespace titop
