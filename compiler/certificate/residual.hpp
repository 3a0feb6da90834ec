#pragma once

#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/linalg/rounding.hpp>

/// Residual of the equations, as the user wrote them and as the blocks define them. For the
/// compiler's own files only.
namespace titop::detail {

/// Larger errors are reported in the log. A dense model's are computed a second time first.
using linalg::kWarn;
/// Times the rounding of a value: it has a digit; times another error: it is one digit worse.
inline constexpr double kAnotherDigit = 10;

/// All signals of one input, at one real s or at one instant.
struct Signals {
  std::vector<int> first = {};             ///< of every signal in `values`, and the end
  solve::RowMatrix<double> values = {};    ///< one column
  solve::RowMatrix<double> unknowns = {};  ///< of the joint system as written
  solve::RowMatrix<double> rounding = {};  ///< one sample of it, as `values`; none: not known
  double s = 0;  ///< xdot = s x, positions are accelerations over s^2. 0: an instant, where xdot is
                 ///< A x + B u by definition and positions there must be none
};

/// First row of signal i among all, and the end.
std::vector<int> first_of_signals(const Graph& graph);

struct WrittenResidual {
  double worst = 0;   ///< Certificate::residual
  std::string where;  ///< the equation or block that has it
};

/// Largest |left - right| over (sum of magnitudes of the terms) of all equations of Stage::source
/// and all rows of all blocks. Zeros at rounding level do not count, nor, if a sample of rounding
/// is known, a difference below kNoise times its effect on the terms, or below kProductRounding of
/// the largest of its kind in over-constrained chains. Values that are not finite count as 1.
/// O(terms).
WrittenResidual written_residual(const Factored& d, const Signals& signals);

}  // namespace titop::detail
