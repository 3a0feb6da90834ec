#pragma once

#include <span>
#include <titop/compiler/solve/factored.hpp>
#include <vector>

/// Well-posedness of the algebraic loops: Certificate::margin. For the compiler's own files only.
namespace titop::detail {

/// Margins of these loops of the stage into the list, one per loop; others are left as they are. 1
/// for a single unknown; 0 if it is not found: of loops of more than 120 unknowns, and if the
/// loop's matrix has no inverse in double. The factors are not used. A dense inverse per loop.
void find_margins(const Factored& data, std::span<const int> loops, std::vector<double>& margins);

/// The same for the changed loops of the data, in Factored::margins.
void update_margins(Factored& data);

/// Summary of the margins of all loops of the stage.
struct WellPosedness {
  double largest = 1;
  int largest_loop = -1;    ///< whose margin it is; -1: none exceeds 1
  int without_digit = -1;   ///< the first loop without a digit in double, by its margin, or without
                            ///< an inverse; -1: none
  int without_inverse = 0;  ///< number of loops
  int too_large = 0;        ///< number of loops, of more than kMarginUpTo unknowns
};
WellPosedness judge_margins(const Stage& stage, std::span<const double> margins);

/// Unknowns of a loop; above it a dense inverse costs too much.
inline constexpr int kMarginUpTo = 120;

}  // namespace titop::detail
