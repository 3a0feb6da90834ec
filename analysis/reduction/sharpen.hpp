#pragma once

#include <titop/analysis/reduction/whole.hpp>

namespace titop::detail {

/// Recomputes the frequencies of the modes up to `high` [rad/s] as poles of the factored transfer
/// (zeros of 1 / H of the pair in which the mode is most visible, by secants in s^2): G has lost
/// the digits by which the mass of a body exceeds that of its modes, the factors have not. Modes
/// that are poorly visible in all pairs keep theirs (unless one of the same frequency, to the last
/// bit, is visible: they keep one), those that would move more than a third of the way to a
/// neighbour, and all if damping couples them. About four transfers per mode.
void sharpen(Whole& whole, const System& system, double high);

}  // namespace titop::detail
