#pragma once

#include <titop/compiler/instant.hpp>

namespace titop::detail {

/// Digits may be lost of what moves a state, or of an output: `now` and Instant::doubt differ by
/// more than kWarn there, and by more than what is left of a 0. One more solution, O(bodies).
bool digits_in_doubt(const SystemData& d, const Instant& now);

}  // namespace titop::detail
