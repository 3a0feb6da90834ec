#pragma once

#include <span>
#include <titop/compiler/certificate/certificate.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <vector>

namespace titop::detail {

/// Result of `certify`.
struct Check {
  Certificate certificate;
  std::vector<Note> notes;  ///< all of the system, its own at the end
  double lost = 0;          ///< of the outputs, by rounding, in double; 0 if it was not computed
  bool rounding_alone = false;  ///< some output is at rounding level, as far as computed
  int loop_without_digit = -1;  ///< of the stage, by its margin, or without one in double
  double least = 0;             ///< see least_pivot
};

/// Margins of these loops of the stage, others left as they are.
void find_margins(const Factored& data, std::span<const int> loops, std::vector<double>& margins);

/// The largest of these margins, one per loop, into the certificate.
void worst_margin(const Factored& data, std::span<const double> margins, Check& check);

/// Certificate of the factors: see certify.cpp.
Check certify(const Factored& data);

}  // namespace titop::detail
