#pragma once

#include <titop/analysis/control/loop_response.hpp>
#include <titop/analysis/control/margins.hpp>

/// The two counts of unstable closed-loop poles. For the folder's own files.
namespace titop::detail {

/// Poles of L and of the closed loop, and the turns of det(1 + L) along the axis: right of poles
/// of L on the axis by half circles of a third of the distance to the next pole, open or closed;
/// with a delay, whose closed-loop poles are not known, smaller ones, on which |L| > 10.
/// Steps along the axis are halved until the determinant turns by less than half a radian in each
/// half; they begin at each pole and at distances from it that grow by 4. `period`: as sided_poles.
NyquistCount nyquist_count(const StateSpace& L, const LoopResponse& response, double period = 0);

/// Margins of a loop transfer with a delay [s], or with a period [s], else 0, of the discrete one
/// whose image it is: frequencies are then those of w. Throws as `margins`.
Margins margins_of(const StateSpace& L, double delay, double period);

}  // namespace titop::detail
