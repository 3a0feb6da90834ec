#pragma once

#include <titop/compiler/evaluate.hpp>

/// How well the equations hold, as the user wrote them and as the blocks state them. For the
/// compiler's own files only.
namespace titop::detail {

struct WrittenResidual {
  double worst = 0;   ///< Certificate::residual
  std::string where;  ///< the equation or block that has it
};

/// Largest |left - right| over (sum of magnitudes of the terms) of all equations of Stage::source
/// and all rows of all blocks, with the signals of `point`, which was evaluated at s (real: half
/// the arithmetic) with one column of inputs. What is 0 but for rounding does not count; what is
/// not finite counts as 1. O(terms).
WrittenResidual written_residual(const SystemData& d, const Evaluation<double>& point, double s);

}  // namespace titop::detail
