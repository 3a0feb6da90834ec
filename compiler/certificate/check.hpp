#pragma once

#include <titop/compiler/certificate/certificate.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <vector>

namespace titop::detail {

/// Result of `certify`.
struct Check {
  Certificate certificate;
  std::vector<Note> notes;  ///< its own
  double lost = 0;          ///< of the outputs, by rounding, in double; 0 if it was not computed
  bool rounding_alone = false;  ///< some output is at rounding level, as far as computed
};

/// Certificate of the factors, a function of them alone: nothing before it depends on it.
/// O(bodies), and the margins of Factored::changed_loops.
Check certify(const Factored& data);

}  // namespace titop::detail
