#pragma once

#include <titop/compiler/certificate/certificate.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <utility>
#include <vector>

namespace titop::detail {

/// Result of `certify`.
struct Check {
  Certificate certificate;
  std::vector<Note> notes;   ///< its own
  bool digits_lost = false;  ///< in equations, pivots, loops or outputs: one of the notes warns
  double lost = 0;           ///< of the outputs, by rounding, in double; 0 if it was not computed
  bool rounding_alone = false;  ///< some output is at rounding level, as far as computed

  void warn(std::string text) {
    notes.push_back({Note::Kind::warning, "certify", std::move(text)});
    digits_lost = true;
  }
};

/// Certificate of the factors, a function of them alone: nothing before it depends on it.
/// O(bodies), and the margins of Factored::changed_loops.
Check certify(const Factored& data);

}  // namespace titop::detail
