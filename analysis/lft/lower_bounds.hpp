#pragma once

#include <string>
#include <titop/compiler/passes/stage.hpp>
#include <vector>

namespace titop::detail {

/// Degrees of a transfer in each of its opened parameters: no realization has fewer occurrences.
struct LowerBounds {
  std::vector<int> at_least;  ///< per parameter of the list
  int states = 0;             ///< degree in s; 0 if not requested
  std::string why_not;        ///< not computed
};

/// For an opened diagram (Stage::opened). Degree: rank of the Loewner matrix of as many random
/// points as `most` + 2 at random values of all else [Antoulas, Anderson 1986], in arithmetic
/// without rounding (compiler/definition/exact/residue.hpp): never too high for the data as they
/// are, with rotations exact within their rounding; too low with a probability below 1e-14. `most`:
/// the occurrences found per parameter; `states`: those of the realization, 0: not requested. Not
/// computed if chains close, which they do only up to rounding, and for more than 200 states.
LowerBounds lower_bounds(const Stage& stage, ParameterValues values,
                         const std::vector<int>& parameters, const std::vector<int>& most,
                         int states);

}  // namespace titop::detail
