#pragma once

#include <Eigen/Core>
#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/linalg/rounding.hpp>

/// The digits that the factors have, by a solution of the joint system that is known: random
/// numbers, of the size of each unknown (ColumnScale::of_unknowns). For the compiler's own files
/// only.
namespace titop::detail {

/// An unknown is found if its relative error is at most this.
using linalg::kThreeDigits;

/// Relative errors of all unknowns, if the factors F solve for the known solution x of L x = b:
/// F^-1 (L - F) x. About eps times the condition number in the scale of x; of factors of a singular
/// L that are regular by rounding alone, F^-1 L v = 0 takes away all of x along the null vector v:
/// an error of about 1 (0.02 and more, measured on 62 loops), whatever the pivots are. One product
/// with L and one solution: O(bodies).
Eigen::ArrayXd errors_of_known_solution(const Factored& data);

/// The errors that remain after refinement of that solution, with residuals in 50 digits, until
/// all are below kThreeDigits. Each step multiplies the error by I - F^-1 L: it does not change the
/// error along v, and removes the errors of unknowns whose scale is far off. Up to ten such steps.
Eigen::ArrayXd errors_left_of_known_solution(const Factored& data);

}  // namespace titop::detail
